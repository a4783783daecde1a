// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::mend {

/// Gives a model colours of the kind that a scan has: one with vertex or face
/// colours and no texture gets the model's texture sampled into such. Where the
/// scan has a texture, a model with vertex or face colours keeps them, as
/// vertex colours. A scan without colours takes none.
void take_kind_of_colors(const Mesh& scan, Mesh& model);

/// Vertex colours from a mesh's texture or face colours, or nothing if it has neither.
std::vector<Color> sampled_vertex_colors(const Mesh& mesh);

/// Where a textured scan has taken a patch with vertex colours: its own vertices
/// get theirs from its texture, or they would be white.
/// @param scan    as it was; @param source  per face of the mesh: its number there, or < 0
void color_vertices_of_scan(const Mesh& scan, const std::vector<int>& source, Mesh& mesh);

/// Makes a patch's vertex colours go on from the scan's: what these differ by
/// at the rim is carried over the patch by a membrane, in linear light (Perez,
/// Gangnet, Blake, "Poisson image editing", 2003).
/// Where the scan has none, nothing changes.
/// @param scan, source  as above
/// @param model         what was pasted, with vertex colours
void match_colors(const Mesh& scan, const Mesh& model, const std::vector<int>& source, Mesh& mesh);

}  // namespace parts::mend
