// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "parts/mesh/mesh.h"

namespace parts::cut {

/// A box of cubic voxels. Voxel (i, j, k) covers origin + size * [i, i+1) × …
struct Grid {
  Vec3 origin = Vec3::Zero();
  double size = 1;  ///< side of a voxel, world units
  std::array<int, 3> dims{0, 0, 0};

  std::size_t count() const { return std::size_t(dims[0]) * dims[1] * dims[2]; }
  std::size_t index(int i, int j, int k) const { return i + std::size_t(dims[0]) * (j + std::size_t(dims[1]) * k); }
  std::array<int, 3> cell(std::size_t index) const {
    const std::size_t row = index / dims[0];
    return {int(index % dims[0]), int(row % dims[1]), int(row / dims[1])};
  }
  bool inside(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < dims[0] && j < dims[1] && k < dims[2];
  }
  /// World to voxel units: voxel (i, j, k) covers [i, i+1) × …
  Vec3 to_grid(const Vec3& p) const { return (p - origin) / size; }
  Vec3 center(int i, int j, int k) const { return origin + size * Vec3(i + 0.5, j + 0.5, k + 0.5); }
  Box box() const { return Box(origin, origin + size * Vec3(dims[0], dims[1], dims[2])); }

  /// The grid over a box with `resolution` voxels along its longest side. Sides
  /// are widened to whole voxels, and a voxel is added all around.
  static Grid over(const Box& box, int resolution) {
    Grid g;
    const Vec3 sides = box.sizes();
    g.size = sides.maxCoeff() / resolution;
    for (int d = 0; d < 3; ++d) g.dims[d] = std::max(1, int(std::ceil(sides[d] / g.size - 1e-9))) + 2;
    g.origin = box.center() - 0.5 * g.size * Vec3(g.dims[0], g.dims[1], g.dims[2]);
    return g;
  }
};

}  // namespace parts::cut
