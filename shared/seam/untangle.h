// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::seam {

/// Parts faces near the seam that cross others: their movable vertices are
/// relaxed to their neighbours' mean, wider around each round, until nothing at
/// a movable vertex crosses anything or the rounds are used up; the positions
/// with the fewest crossings stay. Boundary vertices do not move.
/// @param movable  per vertex
/// @return the pairs of crossing faces that are left, of those with a movable vertex
long untangle(Mesh& mesh, const std::vector<char>& movable, int rounds, int threads);

}  // namespace parts::seam
