// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/smooth_field.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/laplacian.h"

namespace parts::mend {

struct SmoothField::Solver {
  using Matrix = Eigen::SparseMatrix<double>;
  const std::vector<Vec3> points;
  Eigen::VectorXd area;        ///< per vertex, in units of the mean
  double unit = 1;             ///< world units: the root of the mean vertex area
  Matrix bilaplacian;          ///< in those units
  std::vector<int> component;  ///< per vertex, numbered by a vertex of it
  Eigen::SimplicialLDLT<Matrix> cholesky;
  bool analyzed = false;

  explicit Solver(const Mesh& mesh) : points(mesh.vertices), area(Eigen::VectorXd::Zero(mesh.vertex_count())) {
    const int n = mesh.vertex_count();
    DisjointSets sets(n);
    for (const Triangle& f : mesh.faces) sets.unite(f[0], f[1]), sets.unite(f[0], f[2]);
    const mesh::Laplacian l = mesh::laplacian(points, mesh.faces);
    area = l.area;
    for (int v = 0; v < n; ++v) component.push_back(sets.find(v));
    const double mean = area.mean();
    unit = std::sqrt(std::max(mean, 1e-300));
    area = (area / std::max(mean, 1e-300)).cwiseMax(0.05);
    bilaplacian = l.matrix.transpose() * area.cwiseInverse().asDiagonal() * l.matrix;
  }
};

SmoothField::SmoothField(const Mesh& mesh) : solver_(std::make_unique<Solver>(mesh)) {}
SmoothField::~SmoothField() = default;

namespace {

/// Components without a target move as one, with the nearest vertex that has one.
template <class Solver>
void follow_nearest(const Solver& s, const std::vector<char>& known, const std::vector<double>& weight,
                    std::vector<Vec3>& field) {
  const int n = int(s.points.size());
  std::vector<Vec3> sum(n, Vec3::Zero());
  std::vector<int> count(n, 0), nearest(n, -1);
  for (int v = 0; v < n; ++v)
    if (const int c = s.component[v]; !known[c]) sum[c] += s.points[v], ++count[c];
  for (int c = 0; c < n; ++c) {
    if (!count[c]) continue;
    double least = 1e300;
    for (int u = 0; u < n; ++u)
      if (weight[u] > 0)
        if (const double d = (s.points[u] - sum[c] / count[c]).squaredNorm(); d < least) least = d, nearest[c] = u;
  }
  for (int v = 0; v < n; ++v)
    if (const int u = nearest[s.component[v]]; u >= 0) field[v] = field[u];
}

}  // namespace

std::vector<Vec3> SmoothField::operator()(const std::vector<Vec3>& target, const std::vector<double>& weight,
                                          double length) {
  Solver& s = *solver_;
  const int n = int(s.points.size());
  const double stiff = std::max(std::pow(length / s.unit, 4), 1e-6);
  std::vector<char> known(n, 0);  // per component
  for (int v = 0; v < n; ++v) known[s.component[v]] |= weight[v] > 0;
  Solver::Matrix system = stiff * s.bilaplacian;
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(n, 3);
  for (int v = 0; v < n; ++v) {
    // A component that nothing is known of must not make the system singular.
    system.coeffRef(v, v) += known[s.component[v]] ? weight[v] * s.area[v] + 1e-12 * stiff : 1;
    if (weight[v] > 0) right.row(v) = weight[v] * s.area[v] * target[v].transpose();
  }
  if (!s.analyzed) s.cholesky.analyzePattern(system), s.analyzed = true;
  s.cholesky.factorize(system);
  Eigen::MatrixX3d solved = Eigen::MatrixX3d::Constant(n, 3, std::nan(""));
  if (s.cholesky.info() == Eigen::Success) solved = s.cholesky.solve(right);
  std::vector<Vec3> field(n);
  for (int v = 0; v < n; ++v) field[v] = solved.row(v).transpose();
  follow_nearest(s, known, weight, field);
  return field;
}

}  // namespace parts::mend
