// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// Gives each fan of faces around the vertices that are asked about a vertex of
/// its own, at the same place: where two fans touch in one, a surface is no manifold.
/// @param asked  per vertex
/// @return the vertex that each new one is a copy of; new ones follow the old
std::vector<int> split_pinches(Mesh& mesh, const std::vector<char>& asked);

/// Welds the ends of edges without length, as they come about where a hole is
/// closed that passes a pinch from fan to fan; faces that then are none go.
/// Where that would leave a non-manifold edge, the edge stays.
/// @param of_face  an entry a face, follows the faces
void weld_steps(Mesh& mesh, std::vector<int>& of_face);

}  // namespace parts::mesh
