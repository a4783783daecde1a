// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/bits.h"
#include "parts/cut/grid.h"

namespace parts::cut {

/// What passes through a voxel, as bit flags.
enum VoxelFlag : std::uint8_t { kHasA = 1, kHasB = 2, kKeepA = 4, kKeepB = 8 };

/// The surface of one model outside the transition volume: an edge-connected
/// piece that is kept or dropped whole, and the voxels where it comes in.
struct OuterPiece {
  bool of_a = true;
  bool keep = false;                ///< holds a constrained face
  std::vector<std::size_t> voxels;  ///< sorted, unique voxel indices
};

/// The joint rasterisation of two models in the transition volume: its
/// non-empty voxels, numbered in index order, with what each holds.
struct JointVoxels {
  Grid grid;
  VoxelSet set;                     ///< the non-empty voxels
  std::vector<std::size_t> cells;   ///< voxel index per node
  std::vector<std::uint8_t> flags;  ///< VoxelFlags per node
  std::vector<OuterPiece> outer;

  long size() const { return long(cells.size()); }
  bool both(int node) const { return (flags[node] & 3) == 3; }
  /// The node at a voxel, -1 if it is empty or outside the grid.
  int at(int i, int j, int k) const { return grid.inside(i, j, k) ? set.node(grid.index(i, j, k)) : -1; }
};

/// Builds the joint voxels from each model's voxels and constrained voxels.
JointVoxels join(const Grid& grid, const VoxelSet& a, const VoxelSet& b, const VoxelSet& keep_a,
                 const VoxelSet& keep_b);

/// The three positive N6 neighbours of every node: calls visit(node, neighbour).
template <class Visit>
void for_each_edge(const Grid& grid, const VoxelSet& set, const std::vector<std::size_t>& cells, const Visit& visit) {
  const std::size_t step[3] = {1, std::size_t(grid.dims[0]), std::size_t(grid.dims[0]) * grid.dims[1]};
  for (int n = 0; n < int(cells.size()); ++n) {
    const std::array<int, 3> c = grid.cell(cells[n]);
    for (int d = 0; d < 3; ++d) {
      if (c[d] + 1 >= grid.dims[d]) continue;
      const int m = set.node(cells[n] + step[d]);
      if (m >= 0) visit(n, m);
    }
  }
}

}  // namespace parts::cut
