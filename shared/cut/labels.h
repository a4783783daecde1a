// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/joint.h"

namespace parts::cut {

/// A minimal cut as a label a node of JointVoxels: whose surface is kept there.
struct VoxelLabels {
  enum Label : std::int8_t { kB = -1, kSeam = 0, kA = 1 };
  std::vector<std::int8_t> label;  ///< per node; kSeam only from the refined cut
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

struct RefinedOptions {
  int reach = 0;  ///< voxels; both surfaces within this distance make an intersection voxel
};

/// A minimal *vertex* cut through the intersection voxels: a seam voxel is one
/// through which both borders pass, so the cost is the length of the seam, and
/// sheets that only one model occupies cannot be cut at all (no amputations).
/// A seam voxel costs more where the surfaces are at an angle, and at the rim of
/// their overlap, less deep in it. Where surfaces cross, directed arcs between
/// their sheets see to it that both lose a side, or none. Sheets that the seam
/// cuts off from both constraints are dropped.
/// cost is the sum of the seam voxels' weights, and of arcs that had to be cut.
/// @param normal_a, normal_b  per node, the summed unit normals of each model's faces in it
VoxelLabels refined_cut(const JointVoxels& voxels, const std::vector<Eigen::Vector3f>& normal_a,
                        const std::vector<Eigen::Vector3f>& normal_b, const RefinedOptions& options);

}  // namespace parts::cut
