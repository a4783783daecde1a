// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/loops.h"

namespace parts::seam {

/// A border contour that the cut made, or that it made in part: of an open
/// model it runs on along the border that the model had.
struct Contour {
  mesh::Loop loop;
  std::vector<char> own;  ///< per half-edge, from vertex i to the next: the input's own border
};

struct ZipperedPieces {
  std::vector<mesh::Loop> open;  ///< contours that are left, of a's, b's and bridges' half-edges
  int strips = 0;                ///< pieces that were zippered
  double length = 0;             ///< of a's part in them, world units
};

/// Zippers contours piece by piece where they do not pair off one to one (two
/// of a facing one of b, a chain facing a part of a loop): bridges between
/// mutually nearest vertices, no longer than max_gap, part them into pieces, and
/// facing pieces are zippered, up to where chains end. The inputs' own borders
/// are joined to what the cut made of the other, where that is no farther than
/// max_gap, never to each other: a hole that both had stays.
/// @param like  per vertex: the face that a new face at it is dressed as
ZipperedPieces zipper_pieces(Mesh& mesh, const std::vector<Contour>& a, const std::vector<Contour>& b, double max_gap,
                             const std::vector<int>& like);

/// The same for contours that the cut made all around.
ZipperedPieces zipper_pieces(Mesh& mesh, const std::vector<mesh::Loop>& a, const std::vector<mesh::Loop>& b,
                             double max_gap, const std::vector<int>& like);

}  // namespace parts::seam
