// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/prepare.h"

#include <cstring>
#include <numeric>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/pinches.h"

namespace parts::mesh {

std::vector<int> first_at_same_place(const Mesh& mesh) {
  const auto less = [&](int a, int b) {
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b];
    for (int d = 0; d < 3; ++d)
      if (p[d] != q[d]) return p[d] < q[d];
    return a < b;
  };
  std::vector<int> order;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.vertices[v].allFinite()) order.push_back(v);
  std::sort(order.begin(), order.end(), less);
  std::vector<int> first(mesh.vertices.size());
  std::iota(first.begin(), first.end(), 0);
  for (std::size_t i = 1; i < order.size(); ++i)
    if (mesh.vertices[order[i]] == mesh.vertices[order[i - 1]]) first[order[i]] = first[order[i - 1]];
  return first;
}

Mesh welded(const Mesh& mesh) {
  const std::vector<int> first = first_at_same_place(mesh);
  Mesh w;
  w.vertices = mesh.vertices;
  w.faces.reserve(mesh.faces.size());
  for (const Triangle& f : mesh.faces) w.faces.push_back({first[f[0]], first[f[1]], first[f[2]]});
  return w;
}

namespace {

/// Flags 1 for the faces that are triangles, each set of three vertices once.
std::vector<char> real_faces(const Mesh& mesh) {
  std::vector<char> real(mesh.faces.size(), 0);
  std::vector<std::pair<Triangle, int>> sorted;
  for (int f = 0; f < mesh.face_count(); ++f) {
    Triangle t = mesh.faces[f];
    real[f] = t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    for (int v : t) real[f] = real[f] && mesh.vertices[v].allFinite();
    std::sort(t.begin(), t.end());
    if (real[f]) sorted.emplace_back(t, f);
  }
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (sorted[i].first == sorted[i - 1].first) real[sorted[i].second] = 0;
  return real;
}

/// Numbers the components over shared edges, and says which are closed.
void find_components(const std::vector<HalfEdge>& edges, Prepared& p) {
  DisjointSets sets(p.mesh.face_count());
  for_each_mesh_edge(edges, [&](auto first, auto last) {
    for (auto e = first + 1; e < last; ++e) sets.unite(first->face, e->face);
  });
  p.component.assign(p.mesh.faces.size(), -1);
  for (int f = 0; f < p.mesh.face_count(); ++f) {
    const int root = sets.find(f);
    p.component[f] = root == f ? p.components++ : p.component[root];
  }
  p.closed.assign(p.components, 1);
  for_each_mesh_edge(edges, [&](auto first, auto last) {
    if (last - first == 1) p.closed[p.component[first->face]] = 0;
  });
}

void turn(Mesh& mesh, int f) {
  std::swap(mesh.faces[f][1], mesh.faces[f][2]);
  if (!mesh.wedges.empty()) std::swap(mesh.wedges[f].uv[1], mesh.wedges[f].uv[2]);
}

/// Makes neighbours across manifold edges agree, each connected patch turned to
/// what most of its area says.
void orient(const std::vector<HalfEdge>& edges, Prepared& p) {
  std::vector<std::vector<std::pair<int, bool>>> next;  // filled only if something disagrees
  bool agree = true;
  for_each_mesh_edge(edges, [&](auto first, auto last) {
    if (last - first == 2 && first->from == first[1].from) agree = false;
  });
  if (agree) return;
  next.resize(p.mesh.faces.size());
  for_each_mesh_edge(edges, [&](auto first, auto last) {
    if (last - first != 2) return;
    const bool opposed = first->from == first[1].from;
    next[first->face].emplace_back(first[1].face, opposed);
    next[first[1].face].emplace_back(first->face, opposed);
  });
  std::vector<signed char> side(p.mesh.faces.size(), 0);
  for (int seed = 0; seed < p.mesh.face_count(); ++seed) {
    if (side[seed]) continue;
    std::vector<int> patch{seed};
    side[seed] = 1;
    double balance = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const int f = patch[i];
      const Mesh& m = p.mesh;
      balance += side[f] * (m.corner(f, 1) - m.corner(f, 0)).cross(m.corner(f, 2) - m.corner(f, 0)).norm();
      for (const auto& [g, opposed] : next[f])
        if (!side[g]) side[g] = opposed ? -side[f] : side[f], patch.push_back(g);
    }
    for (int f : patch)
      if (side[f] == (balance < 0 ? 1 : -1)) turn(p.mesh, f), ++p.reversed_faces;
  }
}

}  // namespace

Prepared prepare(const Mesh& mesh) {
  Prepared p;
  Mesh welded = mesh;
  const std::vector<int> first = first_at_same_place(mesh);
  std::vector<char> shared(first.size(), 0);
  for (std::size_t v = 0; v < first.size(); ++v)
    if (first[v] != int(v)) shared[first[v]] = 1, ++p.welded_vertices;
  for (Triangle& f : welded.faces)
    for (int& v : f) v = first[v];
  std::vector<int> old_vertex;
  p.mesh = take_faces(welded, real_faces(welded), &old_vertex, &p.source_face);
  // What only touched at a vertex is two surfaces again.
  std::vector<char> touching;
  touching.reserve(old_vertex.size());
  for (int v : old_vertex) touching.push_back(shared[v]);
  p.welded_vertices -= int(split_pinches(p.mesh, touching).size());
  p.dropped_faces = mesh.face_count() - p.mesh.face_count();
  const std::vector<HalfEdge> edges = sorted_half_edges(p.mesh);
  find_components(edges, p);
  orient(edges, p);
  return p;
}

}  // namespace parts::mesh
