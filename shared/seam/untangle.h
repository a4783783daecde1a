// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::seam {

/// What untangling has to know of a mesh.
struct Untangling {
  const std::vector<char>& movable;  ///< per vertex
  const std::vector<char>& seam;     ///< per vertex: not 0 on the seam
  const std::vector<char>& tag;      ///< per face: which model it is of
  const std::vector<Vec3>& before;   ///< the vertices before anything moved
  double largest_fold = 0;           ///< world units; larger faces that meet sharply are no fold
  int rounds = 15;
  int threads = 0;  ///< 0 = all cores; the result does not depend on it
};

/// Parts faces near the seam that cross others, and opens those folded onto
/// each other: their movable vertices are relaxed to their neighbours' mean,
/// wider around each round, until nothing at a movable vertex crosses anything
/// or is folded, or the rounds are used up; the positions with the fewest
/// crossings, then folds, stay. Boundary vertices do not move.
/// What crossed or was folded within one model before anything moved, away from
/// the seam, is the input's own: it stays, and does not count.
/// @return the pairs of crossing faces that are left, of those with a movable vertex
std::vector<std::array<int, 2>> untangle(Mesh& mesh, const Untangling& given);

}  // namespace parts::seam
