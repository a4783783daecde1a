// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/transition.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

namespace parts::cut {
namespace {

constexpr int kBand = 4;  // voxels around the seam that are smoothed

/// The eight voxel centres around a point, with their trilinear weights.
struct Stencil {
  std::array<int, 3> base;
  Vec3 t;
  Stencil(const Grid& grid, const Vec3& p) {
    const Vec3 q = grid.to_grid(p) - Vec3::Constant(0.5);
    for (int d = 0; d < 3; ++d) base[d] = int(std::floor(q[d])), t[d] = q[d] - base[d];
  }
  std::array<int, 3> voxel(int corner) const {
    return {base[0] + (corner & 1), base[1] + (corner >> 1 & 1), base[2] + (corner >> 2 & 1)};
  }
  double weight(int corner) const {
    double w = 1;
    for (int d = 0; d < 3; ++d) w *= corner >> d & 1 ? t[d] : 1 - t[d];
    return w;
  }
};

template <class Visit>
void for_each_neighbour(const Grid& grid, std::size_t voxel, int reach, const Visit& visit) {
  const std::array<int, 3> c = grid.cell(voxel);
  for (int k = c[2] - reach; k <= c[2] + reach; ++k)
    for (int j = c[1] - reach; j <= c[1] + reach; ++j)
      for (int i = c[0] - reach; i <= c[0] + reach; ++i)
        if (grid.inside(i, j, k)) visit(grid.index(i, j, k));
}

}  // namespace

Transition Transition::along_voxels(const JointVoxels& voxels, const VoxelLabels& labels) {
  Transition t(voxels, labels);
  t.band_ = VoxelSet(voxels.grid.count());
  t.band_.index();
  t.mark_near();
  return t;
}

Transition Transition::smooth(const JointVoxels& voxels, const VoxelLabels& labels,
                              const std::vector<Vec3>& crossings) {
  Transition t(voxels, labels);
  t.solve(crossings);
  t.mark_near();
  return t;
}

void Transition::solve(const std::vector<Vec3>& crossings) {
  const Grid& grid = voxels_->grid;
  band_ = VoxelSet(grid.count());
  for (long n = 0; n < voxels_->size(); ++n)
    if (labels_->label[n] == VoxelLabels::kSeam)
      for_each_neighbour(grid, voxels_->cells[n], kBand, [&](std::size_t v) { band_.add(v); });
  band_.index();
  const int unknowns = int(band_.size());
  if (unknowns == 0) return;
  const std::vector<std::size_t> cells = band_.cells();

  // Steps from the seam, in the largest coordinate.
  std::vector<int> steps(unknowns, kBand + 1);
  for (long n = 0; n < voxels_->size(); ++n)
    if (labels_->label[n] == VoxelLabels::kSeam) {
      const std::array<int, 3> s = grid.cell(voxels_->cells[n]);
      for_each_neighbour(grid, voxels_->cells[n], kBand, [&](std::size_t v) {
        const std::array<int, 3> c = grid.cell(v);
        int& d = steps[band_.node(v)];
        d = std::min(d, std::max({std::abs(c[0] - s[0]), std::abs(c[1] - s[1]), std::abs(c[2] - s[2])}));
      });
    }

  using Entry = Eigen::Triplet<double>;
  std::vector<Entry> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns), start = Eigen::VectorXd::Zero(unknowns);
  for_each_edge(grid, band_, cells, [&](int p, int q) {
    entries.insert(entries.end(), {Entry(p, p, 1), Entry(q, q, 1), Entry(p, q, -1), Entry(q, p, -1)});
  });
  // The pull to a label grows with the distance from the seam: the border is
  // free to be smooth within two voxels, and stays on its side beyond.
  constexpr double kPull[kBand + 2] = {0, 0.02, 0.2, 1, 10, 10};
  for (int p = 0; p < unknowns; ++p) {
    entries.emplace_back(p, p, 1e-6);
    const int n = voxels_->set.node(cells[p]);
    if (n < 0) continue;
    const int keep = voxels_->flags[n] & (kKeepA | kKeepB);
    const double label = keep == kKeepA ? 1 : keep == kKeepB ? -1 : labels_->label[n];
    const double pull = label == 0 ? 0 : keep ? 10 : kPull[steps[p]];
    entries.emplace_back(p, p, pull);
    right[p] += pull * label;
    start[p] = label;
  }
  constexpr double kCrossing = 4;
  for (const Vec3& x : crossings) {
    const Stencil s(grid, x);
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b) {
        const auto va = s.voxel(a), vb = s.voxel(b);
        if (!grid.inside(va[0], va[1], va[2]) || !grid.inside(vb[0], vb[1], vb[2])) continue;
        const int p = band_.node(grid.index(va[0], va[1], va[2])), q = band_.node(grid.index(vb[0], vb[1], vb[2]));
        if (p >= 0 && q >= 0) entries.emplace_back(p, q, kCrossing * s.weight(a) * s.weight(b));
      }
  }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver(matrix);
  solver.setTolerance(1e-5);
  solver.setMaxIterations(400);
  Eigen::VectorXd x = solver.solveWithGuess(right, start);
  // Short of the tolerance the border is less smooth than it could be; far off it is none.
  constexpr double kUsable = 0.05;
  if (solver.info() != Eigen::Success && !(solver.error() < kUsable)) x = start;
  value_.assign(x.data(), x.data() + unknowns);
}

double Transition::at(int i, int j, int k, bool of_a, bool& known) const {
  known = false;
  if (!voxels_->grid.inside(i, j, k)) return 0;
  const std::size_t v = voxels_->grid.index(i, j, k);
  if (const int p = band_.node(v); p >= 0) return known = true, value_[p];
  const int n = voxels_->set.node(v);
  if (n < 0 || !(voxels_->flags[n] & (of_a ? kHasA : kHasB))) return 0;
  return known = true, labels_->label[n];
}

double Transition::value(const Vec3& p, bool of_a) const {
  bool known;
  if (band_.size() > 0) {
    const Stencil s(voxels_->grid, p);
    double sum = 0, weights = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const auto c = s.voxel(corner);
      const double v = at(c[0], c[1], c[2], of_a, known);
      if (known) sum += s.weight(corner) * v, weights += s.weight(corner);
    }
    if (weights > 1e-9) return sum / weights;
  }
  const Vec3 q = voxels_->grid.to_grid(p);
  const double v = at(int(std::floor(q[0])), int(std::floor(q[1])), int(std::floor(q[2])), of_a, known);
  if (known) return v;
  // On a voxel's very side: any neighbour that holds the surface.
  for (int corner = 0; corner < 8; ++corner) {
    const auto c = Stencil(voxels_->grid, p).voxel(corner);
    const double w = at(c[0], c[1], c[2], of_a, known);
    if (known) return w;
  }
  return of_a ? 1 : -1;
}

void Transition::mark_near() {
  const Grid& grid = voxels_->grid;
  const VoxelSet& set = band_.size() ? band_ : voxels_->set;
  for (const bool of_a : {false, true}) {
    near_[of_a] = VoxelSet(grid.count());
    set.for_each([&](std::size_t v) {
      bool positive = false, negative = false, known = false;
      const std::array<int, 3> c = grid.cell(v);
      for (int k = -1; k <= 1; ++k)
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i) {
            const double x = at(c[0] + i, c[1] + j, c[2] + k, of_a, known);
            positive |= known && x > 0, negative |= known && x < 0;
          }
      if (positive && negative) near_[of_a].add(v);
    });
  }
}

}  // namespace parts::cut
