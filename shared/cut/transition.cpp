// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/transition.h"

namespace parts::cut {

Transition::Transition(const JointVoxels& voxels, const VoxelLabels& labels) : voxels_(voxels), labels_(labels) {
  const Grid& grid = voxels.grid;
  for (const bool of_a : {false, true}) {
    near_[of_a] = VoxelSet(grid.count());
    voxels.set.for_each([&](std::size_t v) {
      bool positive = false, negative = false;
      const std::array<int, 3> c = grid.cell(v);
      for (int k = -1; k <= 1; ++k)
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i) {
            const int label = at(c[0] + i, c[1] + j, c[2] + k, of_a);
            positive |= label > 0, negative |= label < 0;
          }
      if (positive && negative) near_[of_a].add(v);
    });
  }
}

int Transition::at(int i, int j, int k, bool of_a) const {
  const int n = voxels_.at(i, j, k);
  return n >= 0 && (voxels_.flags[n] & (of_a ? kHasA : kHasB)) ? labels_.label[n] : 0;
}

double Transition::value(const Vec3& p, bool of_a) const {
  const Vec3 q = voxels_.grid.to_grid(p);
  std::array<int, 3> c;
  for (int d = 0; d < 3; ++d) c[d] = int(std::floor(q[d]));
  if (const int label = at(c[0], c[1], c[2], of_a)) return label;
  // On a voxel's very side: any neighbour that holds the surface.
  for (int d = 0; d < 3; ++d) c[d] = int(std::floor(q[d] - 0.5));
  for (int corner = 0; corner < 8; ++corner)
    if (const int label = at(c[0] + (corner & 1), c[1] + (corner >> 1 & 1), c[2] + (corner >> 2 & 1), of_a))
      return label;
  return of_a ? 1 : -1;
}

}  // namespace parts::cut
