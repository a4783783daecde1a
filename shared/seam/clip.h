// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "parts/mesh/mesh.h"

namespace parts::seam {

/// What decides where a model is clipped.
struct ClipField {
  std::function<double(const Vec3&)> value;       ///< kept where positive
  std::function<bool(const Mesh&, int)> crosses;  ///< whether the zero set may pass through a face
  double max_edge = 0;                            ///< world units; crossed faces are split to this before
  double crumb = 0;                               ///< world units; smaller pieces that the cut makes are dropped
};

/// A clipped model. Border half-edges run in their face's direction; their ends
/// are new vertices on the zero set.
struct Clipped {
  Mesh mesh;
  std::vector<int> source_face;            ///< per face: its index in the input
  std::vector<char> cut_vertex;            ///< per vertex: 1 if made by the cut
  std::vector<std::array<int, 2>> border;  ///< vertex indices
  std::vector<char> same;                  ///< per face: lies on the other model too; empty: none does
};

/// Clips a mesh by the sign of a field (thesis 3.2.4). Faces that the zero set
/// does not reach are copied unchanged.
/// @param pinned  per face: 1 = kept whole, -1 = dropped unless a neighbour is kept, 0 = by the field
Clipped clip(const Mesh& mesh, const std::vector<signed char>& pinned, const ClipField& field, int threads);

}  // namespace parts::seam
