// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// Pairs of faces that touch or cross where a clean surface would not: faces
/// without a common corner that have a point in common; with one, that have
/// another point in common; with two, that are folded onto each other; with
/// three, always. Corners at the same position are the same corner. Decided by
/// exact predicates; faces without area and non-finite ones are left out.
/// @param limit    stop after that many; 0 = find all
/// @param threads  0 = all cores; the result does not depend on it
/// @return the pairs, lower face first; sorted when there is no limit
std::vector<std::array<int, 2>> intersecting_faces(const Mesh& mesh, long limit = 0, int threads = 0);

/// How many pairs, up to the limit (0 = all).
long self_intersections(const Mesh& mesh, long limit = 0, int threads = 0);

}  // namespace parts::mesh
