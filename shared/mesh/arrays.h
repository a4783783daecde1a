// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// What is wrong with the arrays of a mesh, or "": a corner that is no vertex,
/// an attribute that some vertices or faces have and others do not, a wedge of a
/// texture that is not there. Asked after every reader and before every writer.
std::string array_flaw(const Mesh& mesh);

/// Makes the attributes of faces, where there are any, as long as the faces:
/// white, quality 0, not selected, no texture.
void fill_face_attributes(Mesh& mesh);

}  // namespace parts::mesh
