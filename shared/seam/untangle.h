// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::seam {

/// Parts faces near the seam that cross others, and opens those folded onto
/// each other: their movable vertices are relaxed to their neighbours' mean,
/// wider around each round, until nothing at a movable vertex crosses anything
/// or is folded, or the rounds are used up; the positions with the fewest
/// crossings, then folds, stay. Boundary vertices do not move.
/// What crossed or was folded before anything moved, away from the seam, is the
/// inputs' own: it stays, and does not count.
/// @param movable, seam  per vertex
/// @param before         the vertices before anything moved
/// @param largest_fold   world units; larger faces that meet sharply are no fold
/// @return the pairs of crossing faces that are left, of those with a movable vertex
std::vector<std::array<int, 2>> untangle(Mesh& mesh, const std::vector<char>& movable, const std::vector<char>& seam,
                                         const std::vector<Vec3>& before, double largest_fold, int rounds, int threads);

}  // namespace parts::seam
