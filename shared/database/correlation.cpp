// SPDX-License-Identifier: GPL-3.0-or-later
#include "database/correlation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace parts {
namespace {

constexpr int kSide = Correlation::kSide, kPlane = kSide * kSide, kCount = kSide * kPlane;
using Grid = Correlation::Grid;

int wrapped(int i) { return (i % kSide + kSide) % kSide; }

/// Transforms along all three axes. Each pass transforms the rows and turns the
/// grid by one axis, so that after three all axes are done and back in place.
void transform(Grid& grid, int flags) {
  Grid turned(kCount);
  cv::Mat from(kPlane, kSide, CV_32FC2, grid.data()), to(kSide, kPlane, CV_32FC2, turned.data());
  for (int axis = 0; axis < 3; ++axis) {
    cv::dft(from, from, cv::DFT_ROWS | flags);
    cv::transpose(from, to);
    std::swap(grid, turned);
    from = cv::Mat(kPlane, kSide, CV_32FC2, grid.data());
    to = cv::Mat(kSide, kPlane, CV_32FC2, turned.data());
  }
}

/// A surface in voxels: its share in each, and near which voxels it passes.
class Splat {
 public:
  Splat() : occupied_(kCount, 0), mean_(kCount, Eigen::Vector4d::Zero()) {}

  /// @param p  voxel units; voxel i's centre is at i
  void add(const Vec3& p, double weight) {
    total_ += weight;
    std::array<int, 3> low;
    Vec3 share;
    for (int d = 0; d < 3; ++d) low[d] = int(std::floor(p[d])), share[d] = p[d] - low[d];
    for (int corner = 0; corner < 8; ++corner) {
      double w = weight;
      std::array<int, 3> c;
      for (int d = 0; d < 3; ++d) {
        const int up = corner >> d & 1;
        w *= up ? share[d] : 1 - share[d];
        c[d] = wrapped(low[d] + up);
      }
      occupied_[c[0] + kSide * (c[1] + kSide * c[2])] += w;
    }
    std::array<int, 3> c;
    for (int d = 0; d < 3; ++d) c[d] = wrapped(int(std::lround(p[d])));
    Eigen::Vector4d& m = mean_[c[0] + kSide * (c[1] + kSide * c[2])];
    // Relative to the voxel, as the grid is cyclic.
    for (int d = 0; d < 3; ++d) m[d] += p[d] - std::round(p[d]);
    m[3] += 1;
  }

  double occupied(int i) const { return total_ > 0 ? occupied_[i] / total_ : 0; }
  std::vector<double> near() const {
    constexpr int reach = int(Correlation::kReach) + 1;
    constexpr double reach2 = Correlation::kReach * Correlation::kReach;
    std::vector<double> near(kCount, 0);
    for (int z = 0; z < kSide; ++z)
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
          const Eigen::Vector4d& m = mean_[x + kSide * (y + kSide * z)];
          if (m[3] == 0) continue;
          const Vec3 at = m.head<3>() / m[3];
          for (int c = -reach; c <= reach; ++c)
            for (int b = -reach; b <= reach; ++b)
              for (int a = -reach; a <= reach; ++a) {
                double& n = near[wrapped(x + a) + kSide * (wrapped(y + b) + kSide * wrapped(z + c))];
                n = std::max(n, 1 - (Vec3(a, b, c) - at).squaredNorm() / reach2);
              }
        }
    return near;
  }

 private:
  double total_ = 0;
  std::vector<double> occupied_;
  std::vector<Eigen::Vector4d> mean_;
};

}  // namespace

Correlation::Model Correlation::model(const ModelRaster& raster) {
  Model m;
  const Eigen::AlignedBox3f box = raster.box();
  m.center = box.center().cast<double>();
  m.cell = double(box.sizes().maxCoeff()) / kModelSide;
  for (int d = 0; d < 3; ++d)
    m.range[d] = std::min(kSide / 2 - 1, int(std::ceil(0.5 * double(box.sizes()[d]) / m.cell)) + 1);
  Splat splat;
  for (const RasterPoint& p : raster.samples)
    splat.add((p.at.cast<double>() - m.center) / m.cell + Vec3::Constant(kSide / 2), 1);
  const std::vector<double> near = splat.near();
  m.near.resize(kCount), m.occupied.resize(kCount);
  for (int i = 0; i < kCount; ++i) m.near[i] = float(near[i]), m.occupied[i] = float(splat.occupied(i));
  transform(m.near, 0);
  transform(m.occupied, 0);
  return m;
}

Correlation::Query Correlation::query(const std::vector<Point>& points, const Eigen::Matrix3d& to_voxels_one,
                                      const Eigen::Matrix3d& to_voxels_two) {
  std::array<Splat, 2> splats;
  for (const Point& p : points)
    for (int k = 0; k < 2; ++k) {
      const Vec3 at = (k ? to_voxels_two : to_voxels_one) * p.at;
      const double inside = std::clamp((kWindow - at.norm()) / 1.5, 0.0, 1.0);
      if (inside > 0) splats[k].add(at + Vec3::Constant(kSide / 2), p.weight * inside);
    }
  Query q;
  q.near.resize(kCount), q.occupied.resize(kCount);
  const std::vector<double> one = splats[0].near(), two = splats[1].near();
  for (int i = 0; i < kCount; ++i) {
    q.near[i] = {float(one[i]), float(two[i])};
    q.occupied[i] = {float(splats[0].occupied(i)), float(splats[1].occupied(i))};
  }
  // Unscaled and inverse: sum A(x) D(x + t) = inverse transform of (D's transform times this).
  transform(q.near, cv::DFT_INVERSE);
  transform(q.occupied, cv::DFT_INVERSE);
  return q;
}

std::array<Correlation::Best, 2> Correlation::best(const Query& query, const Model& model) {
  Grid product(kCount);
  for (int i = 0; i < kCount; ++i) {
    // By hand: std::complex's product looks out for infinities, which is slow.
    const auto [a, b] = std::pair(query.occupied[i], model.near[i]);
    const auto [c, d] = std::pair(query.near[i], model.occupied[i]);
    product[i] = {a.real() * b.real() - a.imag() * b.imag() + c.real() * d.real() - c.imag() * d.imag(),
                  a.real() * b.imag() + a.imag() * b.real() + c.real() * d.imag() + c.imag() * d.real()};
  }
  transform(product, cv::DFT_INVERSE);
  std::array<Best, 2> found;
  const Eigen::Vector3i& r = model.range;
  for (int z = -r[2]; z <= r[2]; ++z)
    for (int y = -r[1]; y <= r[1]; ++y)
      for (int x = -r[0]; x <= r[0]; ++x) {
        const std::complex<float>& v = product[wrapped(x) + kSide * (wrapped(y) + kSide * wrapped(z))];
        const float values[2] = {v.real(), v.imag()};
        for (int k = 0; k < 2; ++k)
          if (values[k] > found[k].similarity) found[k] = {{x, y, z}, values[k]};
      }
  for (Best& b : found) b.similarity /= kCount;
  return found;
}

}  // namespace parts
