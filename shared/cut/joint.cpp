// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/joint.h"

namespace parts::cut {

JointVoxels join(const Grid& grid, const VoxelSet& a, const VoxelSet& b, const VoxelSet& keep_a,
                 const VoxelSet& keep_b) {
  JointVoxels v;
  v.grid = grid;
  v.set = a;
  v.set |= b;
  v.set.index();
  v.cells = v.set.cells();
  v.flags.resize(v.cells.size());
  for (std::size_t n = 0; n < v.cells.size(); ++n) {
    const std::size_t c = v.cells[n];
    v.flags[n] = std::uint8_t((a.has(c) ? kHasA : 0) | (b.has(c) ? kHasB : 0) | (keep_a.has(c) ? kKeepA : 0) |
                              (keep_b.has(c) ? kKeepB : 0));
  }
  return v;
}

}  // namespace parts::cut
