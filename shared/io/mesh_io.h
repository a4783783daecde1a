// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "parts/mesh/mesh.h"

namespace parts::io {

/// Reads a .ply, .obj, .off or .stl file with its colours, quality and texture
/// coordinates. Texture file names come back as the file names
/// them, made relative to the current directory or absolute so that they open.
/// @throws UserError  the file is missing, unreadable or holds no face
Mesh read_mesh(const std::string& path);

/// Writes a .ply (binary), .obj or .off file with every attribute that the
/// format holds. @throws UserError  the file cannot be written
void write_mesh(const Mesh& mesh, const std::string& path);

}  // namespace parts::io
