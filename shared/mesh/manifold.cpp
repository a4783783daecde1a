// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/manifold.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/edges.h"

namespace parts::mesh {
namespace {

Mesh without_flaps(Mesh mesh) {
  for (;;) {
    std::vector<char> free_edge(mesh.faces.size(), 0), crowded = free_edge, stays = free_edge;
    for_each_mesh_edge(sorted_half_edges(mesh), [&](auto first, auto last) {
      for (auto e = first; e < last; ++e) {
        if (last - first == 1) free_edge[e->face] = 1;
        if (last - first > 2) crowded[e->face] = 1;
      }
    });
    for (std::size_t f = 0; f < stays.size(); ++f) stays[f] = !(free_edge[f] && crowded[f]);
    if (std::find(stays.begin(), stays.end(), 0) == stays.end()) return mesh;
    mesh = take_faces(mesh, stays);
  }
}

/// The pairs of faces around an edge that bound a body together: each that runs
/// down the edge with the next, counter-clockwise, that runs up.
template <class It>
std::vector<std::array<int, 2>> paired_faces(const Mesh& mesh, It first, It last) {
  if (last - first == 2) return {{first->face, (first + 1)->face}};
  struct Side {
    double angle;
    bool up;
    int face;
  };
  const Vec3 &low = mesh.vertices[first->low()], axis = (mesh.vertices[first->high()] - low).normalized();
  const Vec3 x = axis.unitOrthogonal(), y = axis.cross(x);
  std::vector<Side> sides;
  for (auto e = first; e < last; ++e) {
    const Vec3 to = mesh.center(e->face) - low;
    sides.push_back({std::atan2(to.dot(y), to.dot(x)), e->from == e->low(), e->face});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.angle < b.angle; });
  std::vector<std::array<int, 2>> pairs;
  for (std::size_t i = 0; i < sides.size(); ++i)
    if (const Side& next = sides[(i + 1) % sides.size()]; !sides[i].up && next.up)
      pairs.push_back({sides[i].face, next.face});
  return pairs;
}

/// The corners of faces (3 f + k) that go together around their vertex: those of
/// faces that bound a body together at an edge there.
DisjointSets fans_of(const Mesh& mesh) {
  DisjointSets fans(3 * mesh.face_count());
  const auto corner = [&](int face, int v) {
    int k = 0;
    while (mesh.faces[face][k] != v) ++k;
    return 3 * face + k;
  };
  for_each_mesh_edge(sorted_half_edges(mesh), [&](auto first, auto last) {
    if (last - first < 2) return;
    for (const auto& [f, g] : paired_faces(mesh, first, last))
      for (int v : {first->from, first->to}) fans.unite(corner(f, v), corner(g, v));
  });
  return fans;
}

}  // namespace

Mesh made_manifold(const Mesh& input) {
  Mesh mesh = without_flaps(input);
  DisjointSets fans = fans_of(mesh);
  std::vector<std::map<int, int>> copies(mesh.vertices.size());  // per vertex: a fan, and its number
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) copies[mesh.faces[f][k]].emplace(fans.find(3 * f + k), -1);
  const std::vector<Vec3> before = mesh.vertices;
  std::vector<char> touching(before.size(), 0);
  for (int v = 0; v < int(before.size()); ++v) {
    touching[v] = copies[v].size() > 1;
    for (auto& [fan, number] : copies[v])
      number = fan == copies[v].begin()->first ? v : add_vertex_between(mesh, v, v, 0);
  }
  std::vector<Vec3> toward(mesh.vertices.size(), Vec3::Zero());
  std::vector<int> count(mesh.vertices.size(), 0);
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Triangle old = mesh.faces[f];
    for (int k = 0; k < 3; ++k) {
      if (!touching[old[k]]) continue;
      const int v = mesh.faces[f][k] = copies[old[k]][fans.find(3 * f + k)];
      toward[v] += before[old[(k + 1) % 3]] + before[old[(k + 2) % 3]] - 2 * before[old[k]], count[v] += 2;
    }
  }
  constexpr double kApart = 0.01;
  for (std::size_t v = 0; v < toward.size(); ++v)
    if (count[v]) mesh.vertices[v] += kApart * toward[v] / count[v];
  return mesh;
}

}  // namespace parts::mesh
