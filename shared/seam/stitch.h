// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/loops.h"

namespace parts::seam {

/// How far two facing contours run the same way, from -1 (opposite) to 1: the
/// dot product of the directions from their nearest vertices to those 10 % of
/// the way on (thesis 3.2.5), averaged over starts all along the contours.
double direction_agreement(const Mesh& mesh, const mesh::Loop& a, const mesh::Loop& b);

/// Zippers the gap between two facing contours, a's half-edges and b's running
/// opposite ways. Of all strips between them the one with the shortest cross
/// edges is taken, from the nearest pair of vertices on. Faces are added to the
/// mesh, dressed as face like[v] of the nearest contour vertex v.
void zipper(Mesh& mesh, const mesh::Loop& a, const mesh::Loop& b, const std::vector<int>& like);

struct ZipperedPieces {
  std::vector<mesh::Loop> open;  ///< contours that are left, of a's, b's and bridges' half-edges
  int strips = 0;                ///< pieces that were zippered
  double length = 0;             ///< of a's part in them, world units
};

/// Zippers contours piece by piece where they do not pair off one to one (two
/// of a facing one of b): bridges between mutually nearest vertices, no longer
/// than max_gap, part them into pieces, and facing pieces are zippered.
ZipperedPieces zipper_pieces(Mesh& mesh, const std::vector<mesh::Loop>& a, const std::vector<mesh::Loop>& b,
                             double max_gap, const std::vector<int>& like);

/// Closes a contour with triangles between its own vertices, ear by ear, the
/// best-shaped first.
void cap(Mesh& mesh, const mesh::Loop& loop, const std::vector<int>& like);

}  // namespace parts::seam
