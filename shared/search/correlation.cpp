// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/search/correlation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace parts::search {
namespace {

using Grid = Correlation::Grid;

/// Transforms along all three axes. Each pass transforms the rows and turns the
/// grid by one axis, so that after three all axes are done and back in place.
void transform(Grid& grid, int side, int flags) {
  Grid turned(grid.size());
  const int plane = side * side;
  cv::Mat from(plane, side, CV_32FC2, grid.data()), to(side, plane, CV_32FC2, turned.data());
  for (int axis = 0; axis < 3; ++axis) {
    cv::dft(from, from, cv::DFT_ROWS | flags);
    cv::transpose(from, to);
    std::swap(grid, turned);
    from = cv::Mat(plane, side, CV_32FC2, grid.data());
    to = cv::Mat(side, plane, CV_32FC2, turned.data());
  }
}

/// A surface in voxels: its share in each, and near which voxels it passes.
class Splat {
 public:
  explicit Splat(int side)
      : side_(side), occupied_(std::size_t(side * side * side), 0), mean_(occupied_.size(), Eigen::Vector4d::Zero()) {}

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
        c[d] = low[d] + up;
      }
      occupied_[index(c[0], c[1], c[2])] += w;
    }
    std::array<int, 3> c;
    for (int d = 0; d < 3; ++d) c[d] = int(std::lround(p[d]));
    Eigen::Vector4d& m = mean_[index(c[0], c[1], c[2])];
    // Relative to the voxel, as the grid is cyclic.
    for (int d = 0; d < 3; ++d) m[d] += p[d] - std::round(p[d]);
    m[3] += 1;
  }

  double occupied(int i) const { return total_ > 0 ? occupied_[i] / total_ : 0; }
  std::vector<double> near() const {
    constexpr int reach = int(Correlation::kReach) + 1;
    constexpr double reach2 = Correlation::kReach * Correlation::kReach;
    std::vector<double> near(occupied_.size(), 0);
    for (int z = 0; z < side_; ++z)
      for (int y = 0; y < side_; ++y)
        for (int x = 0; x < side_; ++x) {
          const Eigen::Vector4d& m = mean_[index(x, y, z)];
          if (m[3] == 0) continue;
          const Vec3 at = m.head<3>() / m[3];
          for (int c = -reach; c <= reach; ++c)
            for (int b = -reach; b <= reach; ++b)
              for (int a = -reach; a <= reach; ++a) {
                double& n = near[index(x + a, y + b, z + c)];
                n = std::max(n, 1 - (Vec3(a, b, c) - at).squaredNorm() / reach2);
              }
        }
    return near;
  }

 private:
  int index(int x, int y, int z) const {
    const int m = side_ - 1;  // a power of two
    return (x & m) + side_ * ((y & m) + side_ * (z & m));
  }

  int side_;
  double total_ = 0;
  std::vector<double> occupied_;
  std::vector<Eigen::Vector4d> mean_;
};

}  // namespace

Correlation::Model Correlation::model(const ModelRaster& raster, const Size& size) {
  Model m;
  m.size = size;
  const Eigen::AlignedBox3f box = raster.box();
  m.center = box.center().cast<double>();
  m.cell = double(box.sizes().maxCoeff()) / size.model_side;
  for (int d = 0; d < 3; ++d)
    m.range[d] = std::min(size.side / 2 - 1, int(std::ceil(0.5 * double(box.sizes()[d]) / m.cell)) + 1);
  Splat splat(size.side);
  for (const RasterPoint& p : raster.samples)
    splat.add((p.at.cast<double>() - m.center) / m.cell + Vec3::Constant(size.side / 2), 1);
  const std::vector<double> near = splat.near();
  m.near.resize(near.size()), m.occupied.resize(near.size());
  for (int i = 0; i < int(near.size()); ++i) m.near[i] = float(near[i]), m.occupied[i] = float(splat.occupied(i));
  transform(m.near, size.side, 0);
  transform(m.occupied, size.side, 0);
  return m;
}

Correlation::Query Correlation::query(const std::vector<Point>& points, const Size& size,
                                      const Eigen::Matrix3d& to_voxels_one, const Eigen::Matrix3d& to_voxels_two) {
  std::array<Splat, 2> splats{Splat(size.side), Splat(size.side)};
  for (const Point& p : points)
    for (int k = 0; k < 2; ++k) {
      const Vec3 at = (k ? to_voxels_two : to_voxels_one) * p.at;
      const double inside = std::clamp((kWindow - at.norm()) / 1.5, 0.0, 1.0);
      if (inside > 0) splats[k].add(at + Vec3::Constant(size.side / 2), p.weight * inside);
    }
  Query q;
  const std::vector<double> one = splats[0].near(), two = splats[1].near();
  q.near.resize(one.size()), q.occupied.resize(one.size());
  for (int i = 0; i < int(one.size()); ++i) {
    q.near[i] = {float(one[i]), float(two[i])};
    q.occupied[i] = {float(splats[0].occupied(i)), float(splats[1].occupied(i))};
  }
  // Unscaled and inverse: sum A(x) D(x + t) = inverse transform of (D's transform times this).
  transform(q.near, size.side, cv::DFT_INVERSE);
  transform(q.occupied, size.side, cv::DFT_INVERSE);
  return q;
}

std::array<Correlation::Best, 2> Correlation::best(const Query& query, const Model& model) {
  Grid product(model.near.size());
  for (std::size_t i = 0; i < product.size(); ++i) {
    // By hand: std::complex's product looks out for infinities, which is slow.
    const auto [a, b] = std::pair(query.occupied[i], model.near[i]);
    const auto [c, d] = std::pair(query.near[i], model.occupied[i]);
    product[i] = {a.real() * b.real() - a.imag() * b.imag() + c.real() * d.real() - c.imag() * d.imag(),
                  a.real() * b.imag() + a.imag() * b.real() + c.real() * d.imag() + c.imag() * d.real()};
  }
  transform(product, model.size.side, cv::DFT_INVERSE);
  std::array<Best, 2> found;
  const Eigen::Vector3i& r = model.range;
  const int side = model.size.side, m = side - 1;
  for (int z = -r[2]; z <= r[2]; ++z)
    for (int y = -r[1]; y <= r[1]; ++y)
      for (int x = -r[0]; x <= r[0]; ++x) {
        const std::complex<float>& v = product[std::size_t((x & m) + side * ((y & m) + side * (z & m)))];
        const float values[2] = {v.real(), v.imag()};
        for (int k = 0; k < 2; ++k)
          if (values[k] > found[k].similarity) found[k] = {{x, y, z}, values[k]};
      }
  for (Best& b : found) b.similarity /= double(product.size());
  return found;
}

}  // namespace parts::search
