// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::compose {

/// Where one mesh is cut into a part that rests and a part that moves: a face
/// is in one of the two, whatever the pose.
struct RigidCut {
  std::vector<char> moves;               ///< per face
  std::vector<std::array<int, 2>> seam;  ///< edges between the parts: vertices
  double length = 0;                     ///< of the seam at rest, world units
  double gap = 0;                        ///< mean distance of the seam from its image, world units, over the poses
  double cost = 0;                       ///< of the cut, in lengths of lambda S (see SeamScore), over the poses
};

/// The minimal cut between the faces that rest and those that move, on the
/// mesh's own graph of faces: an edge costs its length times the gap that
/// opens there, the turn of the surface and a price per length, summed over
/// the poses. Vertices at one place count as one. A component without marks
/// goes with the one that it is nearest to.
/// @param poses  where the moving part goes, at least one; all mirror, or none
/// @throws UserError  a face is to rest and to move
RigidCut cut_rigidly(const Mesh& mesh, const std::vector<char>& fixed, const std::vector<char>& moving,
                     const std::vector<Eigen::Affine3d>& poses);

/// Per vertex the share of the pose that it takes: 0 at rest and 1 in the
/// moving part, smooth in between (biharmonic) within `distance` of the seam
/// along the surface. Marked faces keep 0 and 1.
std::vector<double> pose_shares(const Mesh& mesh, const RigidCut& cut, const std::vector<char>& fixed,
                                const std::vector<char>& moving, double distance);

}  // namespace parts::compose
