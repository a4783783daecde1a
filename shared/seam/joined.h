// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/cut.h"
#include "parts/cut/volume.h"
#include "parts/mesh/loops.h"
#include "parts/seam/blend.h"
#include "parts/seam/clip.h"
#include "parts/seam/seam.h"

namespace parts::seam {

/// The two clipped models in one mesh, with what is known of its elements.
struct Joined {
  Mesh mesh;
  std::vector<char> tag;     ///< per face: 0 from A, 1 from B, 2 from the stitch
  std::vector<char> seam;    ///< per vertex: SeamSide, made by the cut
  std::vector<char> fixed;   ///< per vertex: of a kept face
  std::vector<char> same;    ///< per face of the two: lies on the other model too
  std::vector<int> like;     ///< per vertex: a face at it
  std::vector<char> closed;  ///< per vertex: a contour that the cut made all around at such vertices is capped
  /// The contours to be stitched. Of an open model they may run on along the
  /// border that it had; chains, open at both ends, are stitched as well.
  std::vector<mesh::Loop> loops_a, loops_b;
  std::vector<mesh::Loop> own_a, own_b;  ///< borders that the models had; may be joined to what is cut of the other
  std::vector<std::array<int, 2>> own;   ///< half-edges of loops_a and loops_b that were the inputs' border, sorted
  bool may_turn_b = true;                ///< B may be turned over, if the seam says so
  double gap = 0;                        ///< mean distance between the borders before stitching, world units
  SeamBlend blend;                       ///< what finish_seam's blending did
};

/// Puts the clipped models side by side.
Joined join_parts(const cut::Model& a, const Clipped& ca, const cut::Model& b, const Clipped& cb);

/// Zippers borders that face each other, no farther apart than max_gap, turning
/// B over first if it faces the other way: whole contours, then pieces of them,
/// then what is left to the other model's own border. What the cut made all
/// around and nothing faces is capped; pieces that it cut off and that join
/// nothing go, if they are small and nothing of them is kept. Fills the
/// report's seam and loops.
/// @return the length of borders that faced none, world units
double stitch_parts(Joined& joined, double max_gap, SeamReport& report);

/// Removes the seam's slivers, evens it (Mesh), lets the surfaces give way at
/// it (if asked to, and as far as no faces cross by it), smooths it, parts faces that cross, and mends the normals
/// around it.
/// @return pairs of faces at the seam that still cross
long finish_seam(Joined& joined, double voxel, cut::Cut cut, const SeamSmoothing& smoothing, int threads);

}  // namespace parts::seam
