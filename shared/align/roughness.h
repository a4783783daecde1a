// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::align {

/// How far a vertex typically lies off its neighbours' mean, across the
/// surface: about the noise of a scan, and what its edges cut off where it is
/// coarse. The median, world units; 0 where vertices are not shared by faces.
/// @param flags  1 = counts; none = every face
double roughness(const Mesh& mesh, const std::vector<char>& flags);

}  // namespace parts::align
