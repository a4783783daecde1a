// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/topology.h"

#include <algorithm>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/predicates.h"

namespace parts::mesh {
namespace {

bool repeats(const Triangle& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; }

int corner_of(const Triangle& f, int vertex) { return f[0] == vertex ? 0 : f[1] == vertex ? 1 : 2; }

}  // namespace

EdgeMap edge_map(const Mesh& mesh) {
  EdgeMap map;
  map.mate.assign(mesh.faces.size() * 3, EdgeMap::kNone);
  const std::vector<HalfEdge> half_edges = sorted_half_edges(mesh);
  std::vector<int> same;  // the half-edges of one edge
  for_each_mesh_edge(half_edges, [&](auto first, auto last) {
    same.clear();
    int forward = 0;
    for (auto e = first; e != last; ++e) {
      if (repeats(mesh.faces[e->face])) continue;
      same.push_back(3 * e->face + corner_of(mesh.faces[e->face], e->from));
      forward += e->from < e->to;
    }
    if (same.empty()) return;
    ++map.edges;
    if (same.size() == 1) {
      ++map.boundary_edges;
      map.mate[same[0]] = EdgeMap::kBoundary;
    } else if (same.size() == 2) {
      map.inconsistent_edges += forward != 1;
      map.mate[same[0]] = same[1];
      map.mate[same[1]] = same[0];
    } else {
      ++map.nonmanifold_edges;
      for (int h : same) map.mate[h] = EdgeMap::kNonManifold;
    }
  });
  return map;
}

std::vector<int> vertex_components(const Mesh& mesh) {
  DisjointSets sets(mesh.vertex_count());
  for (const Triangle& f : mesh.faces) sets.unite(f[0], f[1]), sets.unite(f[0], f[2]);
  std::vector<int> component(mesh.vertices.size());
  for (int v = 0; v < mesh.vertex_count(); ++v) component[v] = sets.find(v);
  return component;
}

namespace {

/// Walks along a border, from face to face around its vertices.
class BorderWalk {
 public:
  BorderWalk(const Mesh& mesh, const EdgeMap& map) : mesh_(mesh), map_(map), seen_(map.mate.size(), 0) {}

  bool seen(int side) const { return seen_[side] != 0; }

  /// From a border's side on, beginning with its vertex `from`: the vertices up
  /// to and with the last. @return whether it came back to where it began
  bool operator()(int start, int from, std::vector<int>& vertices) {
    int vertex = from;
    for (int side = start;;) {
      seen_[side] = 1;
      vertices.push_back(vertex);
      const Triangle& f = mesh_.faces[side / 3];
      vertex = f[side % 3] == vertex ? f[(side % 3 + 1) % 3] : f[side % 3];
      side = next(side, vertex);
      if (side == start) return true;
      if (side < 0 || seen_[side]) {
        vertices.push_back(vertex);
        return false;
      }
    }
  }

 private:
  /// The border's side that the fan around the vertex ends with, or kNonManifold.
  int next(int side, int vertex) const {
    for (;;) {
      const int corner = corner_of(mesh_.faces[side / 3], vertex);
      const int other = side / 3 * 3 + (side % 3 == corner ? (corner + 2) % 3 : corner);
      side = map_.mate[other];
      if (side < 0) return side == EdgeMap::kBoundary ? other : EdgeMap::kNonManifold;
    }
  }

  const Mesh& mesh_;
  const EdgeMap& map_;
  std::vector<char> seen_;
};

}  // namespace

std::vector<Loop> boundary_loops(const Mesh& mesh, const EdgeMap& map) {
  std::vector<Loop> loops;
  BorderWalk walk(mesh, map);
  for (int start = 0; start < int(map.mate.size()); ++start) {
    if (map.mate[start] != EdgeMap::kBoundary || walk.seen(start)) continue;
    const Triangle& f = mesh.faces[start / 3];
    Loop loop;
    loop.closed = walk(start, f[start % 3], loop.vertices);
    if (!loop.closed) {  // it began in the midst of a chain
      std::vector<int> back;
      walk(start, f[(start % 3 + 1) % 3], back);
      loop.vertices.insert(loop.vertices.begin(), back.rbegin(), back.rend() - 2);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

std::vector<char> nonmanifold_vertices(const Mesh& mesh, const EdgeMap& map) {
  DisjointSets fans(int(map.mate.size()));  // of corners
  std::vector<char> bad(mesh.vertices.size(), 0);
  for (int h = 0; h < int(map.mate.size()); ++h) {
    const Triangle& f = mesh.faces[h / 3];
    const int from = f[h % 3], to = f[(h % 3 + 1) % 3], mate = map.mate[h];
    if (mate == EdgeMap::kNonManifold) bad[from] = bad[to] = 1;
    if (mate < 0) continue;
    const int g = mate / 3;
    fans.unite(h, 3 * g + corner_of(mesh.faces[g], from));
    fans.unite(h / 3 * 3 + (h % 3 + 1) % 3, 3 * g + corner_of(mesh.faces[g], to));
  }
  std::vector<int> fan(mesh.vertices.size(), -1);
  for (int h = 0; h < int(map.mate.size()); ++h) {
    if (map.mate[h] == EdgeMap::kNone) continue;
    const int v = mesh.faces[h / 3][h % 3], set = fans.find(h);
    if (fan[v] >= 0 && fan[v] != set) bad[v] = 1;
    fan[v] = set;
  }
  return bad;
}

namespace {

int count_components(const Mesh& mesh) {
  DisjointSets faces(mesh.face_count());
  const std::vector<HalfEdge> half_edges = sorted_half_edges(mesh);
  for_each_mesh_edge(half_edges, [&](auto first, auto last) {
    int joined = -1;
    for (auto e = first; e != last; ++e) {
      if (repeats(mesh.faces[e->face])) continue;
      if (joined >= 0) faces.unite(joined, e->face);
      joined = e->face;
    }
  });
  int n = 0;
  for (int f = 0; f < mesh.face_count(); ++f) n += faces.find(f) == f && !repeats(mesh.faces[f]);
  return n;
}

}  // namespace

MeshCheck check(const Mesh& mesh) {
  MeshCheck c;
  const EdgeMap map = edge_map(mesh);
  c.edges = map.edges;
  c.boundary_edges = map.boundary_edges;
  c.nonmanifold_edges = map.nonmanifold_edges;
  c.inconsistent_edges = map.inconsistent_edges;
  c.boundary_loops = int(boundary_loops(mesh, map).size());
  const std::vector<char> bad = nonmanifold_vertices(mesh, map);
  c.nonmanifold_vertices = int(std::count(bad.begin(), bad.end(), 1));
  c.components = count_components(mesh);
  std::vector<char> used(mesh.vertices.size(), 0);
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Triangle& t = mesh.faces[f];
    if (repeats(t)) {
      ++c.degenerate_faces;
      continue;
    }
    ++c.faces;
    for (int v : t) used[v] = 1;
    c.degenerate_faces += collinear(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  }
  for (const Vec3& p : mesh.vertices) c.nonfinite_vertices += !p.allFinite();
  c.vertices = int(std::count(used.begin(), used.end(), 1));
  c.unused_vertices = mesh.vertex_count() - c.vertices;
  c.euler = c.vertices - c.edges + c.faces;
  return c;
}

std::string to_string(const MeshCheck& c) {
  const std::pair<const char*, int> rows[] = {
      {"vertices", c.vertices},
      {"edges", c.edges},
      {"faces", c.faces},
      {"components", c.components},
      {"Euler characteristic", c.euler},
      {"boundary edges", c.boundary_edges},
      {"boundary loops", c.boundary_loops},
      {"non-manifold edges", c.nonmanifold_edges},
      {"non-manifold vertices", c.nonmanifold_vertices},
      {"inconsistent edges", c.inconsistent_edges},
      {"degenerate faces", c.degenerate_faces},
      {"non-finite vertices", c.nonfinite_vertices},
      {"unused vertices", c.unused_vertices},
  };
  std::string text;
  for (const auto& [name, value] : rows) text += std::string(name) + ": " + std::to_string(value) + "\n";
  return text;
}

}  // namespace parts::mesh
