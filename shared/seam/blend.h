// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::seam {

/// What blending a seam did.
struct SeamBlend {
  double distance = 0;      ///< world units, as asked for or as chosen
  int moved = 0;            ///< vertices
  double angle_before = 0;  ///< degrees between faces at the seam's edges, in the median
  double angle_after = 0;
};

/// Lets both sides of a seam give way, so that positions and normals agree
/// where they meet and their details stay: to the vertices an offset is added
/// that is a biharmonic membrane on both sides of the seam, nothing at the
/// distance and smooth there (GeoBrush, Takayama et al. 2011, for the idea). Of
/// all offsets it is the one that bends the surface least and takes the crease out
/// of the seam; what the crease was is spread over the band as curvature.
/// Beyond the distance, along the surface, vertices stay as they are, bit for
/// bit, and so do fixed ones. Where a vertex would have to go farther than half the
/// distance and the gap the surfaces fork, and are meant to: they stay as they
/// are there, and everywhere if that is most of the seam or the crease hardly
/// gets smaller.
/// @param seam      per vertex: not 0 on the seam
/// @param fixed     per vertex: 1 stays where it is
/// @param distance  world units, nothing moves if it is less than an edge; 0 = chosen from the angle across the
///                  seam and the step that it was: four to twelve edges, and no more than
///                  6 % of the mesh's size where four are less
/// @param gap       world units; how far the borders were apart before
SeamBlend blend_seam(Mesh& mesh, const std::vector<char>& seam, const std::vector<char>& fixed, double distance,
                     double gap);

}  // namespace parts::seam
