// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// A border contour: vertices in the direction of the faces' half-edges.
/// Closed, or a chain from its first vertex to its last: it ends on a boundary
/// that the input had, or at an edge of more than two faces.
struct Loop {
  std::vector<int> vertices;
  bool closed = true;
  int size() const { return int(vertices.size()); }
  int edges() const { return size() - (closed ? 0 : 1); }
  int next(int i) const { return vertices[(i + 1) % size()]; }  ///< the vertex after the i-th
  std::vector<int>::const_iterator begin() const { return vertices.begin(); }
  std::vector<int>::const_iterator end() const { return vertices.end(); }
};

/// Chains half-edges into contours. At a vertex where contours touch, the
/// first unused half-edge is taken; every half-edge is used once.
std::vector<Loop> trace_loops(const std::vector<std::array<int, 2>>& half_edges);

/// The half-edges of faces that have no opposite one: a mesh's own boundary.
std::vector<std::array<int, 2>> boundary_half_edges(const Mesh& mesh);

double loop_length(const Mesh& mesh, const Loop& loop);

/// Pairs (index in a, index in b) of contours that face each other: the nearest
/// first, none farther apart on average than max_gap.
/// @param gap  out: the length-weighted mean distance of the pairs
std::vector<std::array<int, 2>> match_loops(const Mesh& mesh, const std::vector<Loop>& a, const std::vector<Loop>& b,
                                            double max_gap, double& gap);

}  // namespace parts::mesh
