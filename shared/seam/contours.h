// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "parts/mesh/loops.h"

namespace parts::seam {

using HalfEdges = std::vector<std::array<int, 2>>;

inline bool contains(const HalfEdges& sorted, const std::array<int, 2>& e) {
  return std::binary_search(sorted.begin(), sorted.end(), e);
}

/// Calls visit(half-edge) along a contour.
template <class Visit>
void for_each_half_edge(const mesh::Loop& loop, const Visit& visit) {
  for (int i = 0; i + (loop.closed ? 0 : 1) < loop.size(); ++i)
    visit(std::array<int, 2>{loop.vertices[i], loop.vertices[(i + 1) % loop.size()]});
}

}  // namespace parts::seam
