// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// The step in which the coordinates were written: the largest power of ten
/// that all are whole multiples of, down to what single precision can tell
/// apart at their size. World units; 0 of a mesh without vertices.
double coordinate_step(const Mesh& mesh);

/// Closes slits: border vertices that differ by at most `reach` in every
/// coordinate, as those do that were split at the seam of a texture and rounded
/// since, get the place of the first of them. Vertices of one face stay apart.
/// @param mesh  welded where places are the same
/// @return how many vertices have moved
int close_slits(Mesh& mesh, double reach);

/// As prepare(), but vertices are also welded where the coordinates' own step
/// (both sides of a slit rounded, perhaps more than once) tells them apart.
Mesh prepare_without_slits(const Mesh& mesh);

}  // namespace parts::mesh
