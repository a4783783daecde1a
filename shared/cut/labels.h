// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/joint.h"

namespace parts::cut {

/// A minimal cut as a label a node of JointVoxels: whose surface is kept there.
struct VoxelLabels {
  enum Label : std::int8_t { kB = -1, kA = 1 };
  std::vector<std::int8_t> label;  ///< per node
  std::vector<std::int8_t> outer;  ///< per outer piece, kA or kB
  double cost = 0;                 ///< of the cut, in the cut's own unit
  bool connected = false;          ///< some path led from A's constraint to B's
};

/// The cut of equations 1 and 2 of the thesis, exactly: N6 edges between voxels,
/// weight 1 where only boundary voxels meet, 1/(10k) at intersection voxels.
/// Empty voxels can only break ties (all their edges together cost less than
/// one other edge), so the graph is that of the non-empty voxels alone, with
/// the lexicographic integers k + 1 and 1 (k: number of edges at intersection voxels).
/// An outer piece is a node too; it parts from its voxels at intersections only.
/// cost is the thesis' own sum over those edges.
VoxelLabels thesis_cut(const JointVoxels& voxels);

}  // namespace parts::cut
