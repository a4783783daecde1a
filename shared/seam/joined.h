// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/cut.h"
#include "parts/cut/volume.h"
#include "parts/mesh/loops.h"
#include "parts/seam/clip.h"
#include "parts/seam/seam.h"

namespace parts::seam {

/// The two clipped models in one mesh, with what is known of its elements.
struct Joined {
  Mesh mesh;
  std::vector<char> tag;     ///< per face: 0 from A, 1 from B, 2 from the stitch
  std::vector<char> seam;    ///< per vertex: SeamSide, made by the cut
  std::vector<char> fixed;   ///< per vertex: of a kept face
  std::vector<int> like;     ///< per vertex: a face at it
  std::vector<char> closed;  ///< per vertex: its input component had no boundary
  std::vector<mesh::Loop> loops_a, loops_b;
};

/// Puts the clipped models side by side.
Joined join_parts(const cut::Model& a, const Clipped& ca, const cut::Model& b, const Clipped& cb);

/// Zippers borders that face each other, no farther apart than max_gap, turning
/// B over first if it faces the other way; closes what remains of models that
/// were closed. Fills the report's seam and loops. @return the length of
/// borders that faced none, world units
double stitch_parts(Joined& joined, double max_gap, SeamReport& report);

/// Removes the seam's slivers, evens it (Mesh), smooths it, parts faces that
/// cross, and mends the normals around it.
/// @return pairs of faces at the seam that still cross
long finish_seam(Joined& joined, double voxel, cut::Cut cut, const SeamSmoothing& smoothing, int threads);

}  // namespace parts::seam
