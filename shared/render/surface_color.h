// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::render {

struct Textures;

/// The images that a mesh names, as they are stored; see Textures.
Textures load_textures(const Mesh& mesh);

/// B, G and R, 0..255.
Eigen::Vector3f bgr(const Color& c);

/// A mesh's own colour at a point of a face: its texture, else vertex, else
/// face colours. B, G and R, 0..255.
/// @param barycentric  of the point
/// @param pixels       that the face is to cover, for which the texture's level
///                     is chosen; a large number for the finest
/// @param base         where the mesh has no colour
Eigen::Vector3f surface_color(const Mesh& mesh, const Textures& textures, int face, const Eigen::Vector3f& barycentric,
                              double pixels, const Color& base);

/// Whether a mesh has colours at all: a texture that could be read, vertex or face colours.
bool has_colors(const Mesh& mesh, const Textures& textures);

}  // namespace parts::render
