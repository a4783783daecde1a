// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// One side of a face: from vertex `from` to vertex `to` in the face's order.
struct HalfEdge {
  int from, to, face;
  int low() const { return std::min(from, to); }
  int high() const { return std::max(from, to); }
};

/// Where an edge lies: the same however vertices are numbered.
using EdgePlace = std::array<double, 6>;
inline EdgePlace edge_place(const Mesh& m, int from, int to) {
  const Vec3 &a = m.vertices[from], &b = m.vertices[to];
  return {a.x(), a.y(), a.z(), b.x(), b.y(), b.z()};
}

/// All half-edges, those of the same edge side by side, in a fixed order.
inline std::vector<HalfEdge> sorted_half_edges(const Mesh& mesh) {
  // Sorted by counting on the lower vertex, then within its few.
  std::vector<int> start(mesh.vertices.size() + 2, 0);
  for (const Triangle& f : mesh.faces)
    for (int k = 0; k < 3; ++k) ++start[std::min(f[k], f[(k + 1) % 3]) + 2];
  for (std::size_t v = 2; v < start.size(); ++v) start[v] += start[v - 1];
  std::vector<HalfEdge> edges(mesh.faces.size() * 3);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const HalfEdge e{mesh.faces[f][k], mesh.faces[f][(k + 1) % 3], f};
      edges[start[e.low() + 1]++] = e;
    }
  for (std::size_t v = 0; v + 1 < start.size(); ++v)
    std::sort(edges.begin() + (v ? start[v] : 0), edges.begin() + start[v + 1],
              [](const HalfEdge& a, const HalfEdge& b) {
                return a.high() != b.high() ? a.high() < b.high() : a.face < b.face;
              });
  return edges;
}

/// Calls visit(first, last) for the half-edges of each edge.
template <class Visit>
void for_each_mesh_edge(const std::vector<HalfEdge>& edges, const Visit& visit) {
  for (std::size_t i = 0, j; i < edges.size(); i = j) {
    for (j = i + 1; j < edges.size() && edges[j].low() == edges[i].low() && edges[j].high() == edges[i].high();) ++j;
    visit(edges.begin() + i, edges.begin() + j);
  }
}

}  // namespace parts::mesh
