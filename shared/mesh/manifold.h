// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// The mesh as a manifold, with borders. Flaps go: faces that hang on an edge of
/// more than two faces and have a free edge as well; what hung on them is a piece
/// by itself then. Sheets that touch in an edge or a vertex are parted: each gets a vertex
/// of its own, a hundredth of an edge away from where it was, so that a file
/// that keeps no numbers does not join them again.
/// @param mesh  welded, faces oriented
Mesh made_manifold(const Mesh& mesh);

}  // namespace parts::mesh
