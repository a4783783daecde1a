// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/loops.h"

namespace parts::seam {

/// Closes contours with triangles between their own vertices, ear by ear, the
/// best-shaped first (mesh::cut_ears). Edges and faces that the mesh has
/// already, at the same places, are not made a second time; where nothing else
/// is left, a contour gets a new vertex in its midst.
/// @param like  per vertex: the face that a new face at it is dressed as
void cap(Mesh& mesh, const std::vector<mesh::Loop>& loops, const std::vector<int>& like);
void cap(Mesh& mesh, const mesh::Loop& loop, const std::vector<int>& like);

}  // namespace parts::seam
