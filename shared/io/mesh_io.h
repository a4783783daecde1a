// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/base/files.h"
#include "parts/mesh/mesh.h"

/// Mesh files. The readers are our own where vcglib has some too: its importers
/// write out of bounds, loop or assert on thirteen of the two dozen broken files
/// of the tests, and find an .obj's materials only by changing the directory of
/// the whole process; its .obj exporter keeps six decimals.
namespace parts::io {

/// Reads a .ply, .obj, .off or .stl file with its colours, quality and texture
/// coordinates. Texture file names come back absolute or relative to the current
/// directory, so that they open; those of other systems and machines are looked
/// for beside the mesh file.
/// @param missing  optional: what the file names and is not there, as it names it
/// @throws UserError  the file is missing, unreadable, larger than the memory or
///                    holds no face
Mesh read_mesh(const std::string& path, const Poll& poll = {}, std::vector<std::string>* missing = nullptr);

/// Writes a .ply (binary), .obj or .off file with every attribute that the
/// format holds. @throws UserError  the file cannot be written
void write_mesh(const Mesh& mesh, const std::string& path);

/// The same as one of several files. @param path  where it will be, and from where its textures are named
void add_mesh(OutputFiles& files, const Mesh& mesh, const std::string& path);

}  // namespace parts::io
