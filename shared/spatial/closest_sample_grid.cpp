// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "parts/spatial/closest_point.h"

namespace parts::spatial {

ClosestSampleGrid::ClosestSampleGrid(std::vector<Sample> samples, int cells_along_longest_side)
    : samples_(std::move(samples)) {
  for (const Sample& s : samples_) box_.extend(s.point);
  const double margin = 0.2 * box_.sizes().maxCoeff();
  box_.min().array() -= margin;
  box_.max().array() += margin;
  cell_size_ = box_.sizes().maxCoeff() / cells_along_longest_side;
  for (int d = 0; d < 3; ++d) cells_[d] = std::max(1, int(std::ceil(box_.sizes()[d] / cell_size_)));
  nearest_.assign(std::size_t(cells_[0]) * cells_[1] * cells_[2], -1);
  for (int i = int(samples_.size()) - 1; i >= 0; --i) nearest_[cell(samples_[i].point)] = i;
  spread();
}

int ClosestSampleGrid::cell(const Vec3& p) const {
  int at[3];
  for (int d = 0; d < 3; ++d) {
    const double x = (p[d] - box_.min()[d]) / cell_size_;
    at[d] = int(std::min(std::max(x, 0.0), cells_[d] - 1.0));
  }
  return (at[2] * cells_[1] + at[1]) * cells_[0] + at[0];
}

/// Hands the samples on from cell to cell, forwards then backwards, each cell
/// keeping the one closest to its centre (Danielsson's vector propagation).
void ClosestSampleGrid::spread() {
  const int nx = cells_[0], ny = cells_[1], nz = cells_[2];
  const auto relax = [&](int x, int y, int z, int way) {
    const Vec3 center = box_.min() + cell_size_ * Vec3(x + 0.5, y + 0.5, z + 0.5);
    int& mine = nearest_[(z * ny + y) * nx + x];
    double best = mine < 0 ? INFINITY : (samples_[mine].point - center).squaredNorm();
    // The 13 neighbours that the sweep has passed already.
    for (int k = 0; k < 13; ++k) {
      const int i = x + way * (k % 3 - 1), j = y + way * (k / 3 % 3 - 1), l = z + way * (k / 9 - 1);
      if (i < 0 || j < 0 || l < 0 || i >= nx || j >= ny || l >= nz) continue;
      const int other = nearest_[(l * ny + j) * nx + i];
      if (other < 0 || other == mine) continue;
      const double d = (samples_[other].point - center).squaredNorm();
      if (d < best) best = d, mine = other;
    }
  };
  int rounds = 0;
  do {
    for (int z = 0; z < nz; ++z)
      for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) relax(x, y, z, 1);
    for (int z = nz - 1; z >= 0; --z)
      for (int y = ny - 1; y >= 0; --y)
        for (int x = nx - 1; x >= 0; --x) relax(x, y, z, -1);
  } while (++rounds < 2 || std::count(nearest_.begin(), nearest_.end(), -1) > 0);
}

Closest ClosestSampleGrid::closest(const Vec3& p, int&) const {
  const Sample& s = samples_[nearest_[cell(p)]];
  return {s.point, s.normal};
}

}  // namespace parts::spatial
