// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::seam {

/// How the seam is smoothed after stitching (thesis 3.2.5): positions are
/// averaged with their neighbours'.
struct SeamSmoothing {
  int iterations = 3;
  double distance = 0;        ///< world units from the seam up to which vertices move; 0 = two voxels
  double weight = 0.5;        ///< 0..1, how far a vertex goes to its neighbours' mean
  bool blend = false;         ///< the surfaces give way at the seam first (blend_seam)
  double blend_distance = 0;  ///< world units from the seam up to which they do; 0 = chosen from gap and angle
};

/// What stitching measured.
struct SeamReport {
  double seam_length = 0;  ///< world units
  double seam_gap = 0;     ///< mean distance between the borders before stitching, world units
  int loops_a = 0, loops_b = 0, loops_joined = 0, loops_capped = 0, loops_open = 0;
  int pieces_joined = 0;    ///< strips between borders that do not pair off one to one
  int pieces_dropped = 0;   ///< small ones that the cut severed and nothing was joined to
  bool reversed_b = false;  ///< B's faces were turned to agree with A's
};

/// Which border a vertex was made for, as bits: 3 once the two are one; and
/// whether they were one from the start, so that it lies on both surfaces, and
/// whether these are one surface there: then nothing is to be smoothed.
enum SeamSide : char { kNoSeam = 0, kBorderA = 1, kBorderB = 2, kWelded = 4, kStill = 8 };

/// How short edges at the seam must be to collapse, world units.
struct SeamTidying {
  double within = 0;  ///< along a border, and to its neighbours
  double across = 0;  ///< from one border to the other
  double edge = 0;    ///< the seam's mean edge: no welded vertex sweeps more than its cube
};

/// Removes slivers along a seam: short edges at seam vertices are collapsed
/// where that keeps the surface manifold and turns no face over, first those
/// from border to border, so that the two become one curve; then edges between
/// seam faces are flipped where that opens the smallest angles. Vertices with
/// fixed = 1 stay where they are, and so do faces at which no seam vertex lies.
/// @param seam  per vertex: SeamSide bits, follow the vertices
/// @param tag   per face, follows the faces
void tidy_seam(Mesh& mesh, std::vector<char>& seam, std::vector<char>& fixed, std::vector<char>& tag,
               const SeamTidying& shortest);

/// The last of that once more, after vertices moved.
void flip_seam(Mesh& mesh, std::vector<char>& seam, const std::vector<char>& fixed);

/// Moves vertices of the seam that lie at the very place of another one a little
/// towards their own neighbours: surfaces that only touch there stay two when a
/// reader makes vertices at one place one.
void part_places(Mesh& mesh, const std::vector<char>& seam, const std::vector<char>& fixed);

/// Evens the curve in which the two borders became one: its vertices go to and
/// fro between their neighbours on it (Taubin 1995), which shortens nothing.
/// Welded vertices stay: they are where the surfaces cross.
void even_seam(Mesh& mesh, const std::vector<char>& seam, const std::vector<char>& fixed, int iterations);

/// Averages vertices near the seam with their neighbours (thesis 3.2.5). The
/// effect fades from the seam to `distance`; fixed and boundary vertices stay.
void smooth_seam(Mesh& mesh, const std::vector<char>& seam, const std::vector<char>& fixed, double distance,
                 int iterations, double weight);

}  // namespace parts::seam
