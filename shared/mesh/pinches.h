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

}  // namespace parts::mesh
