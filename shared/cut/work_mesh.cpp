// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/work_mesh.h"

#include "parts/base/parallel.h"
#include "parts/mesh/edges.h"

namespace parts::cut {
namespace {

constexpr double kAgree = 0.2;      // the least cosine of faces that could replace each other
constexpr double kOpposite = -0.2;  // and the largest of vertices that look the other way

/// Whether p lies beside the border of a surface rather than over it.
bool beside_border(const WorkMesh& surface, const WorkMesh::Near& near, const Vec3& p) {
  const Vec3 d = p - near.point;
  return surface.at_border[near.face] && std::abs(d.dot(surface.normal[near.face])) < 0.8 * d.norm();
}

void measure(WorkMesh& w) {
  const Mesh& m = w.mesh;
  w.normal.resize(m.faces.size()), w.area.resize(m.faces.size());
  w.vertex_normal.assign(m.vertices.size(), Vec3::Zero());
  for (int f = 0; f < m.face_count(); ++f) {
    const Vec3 n = m.area_vector(f);
    w.area[f] = 0.5 * n.norm(), w.normal[f] = n.normalized();
    for (int v : m.faces[f]) w.vertex_normal[v] += n;
  }
  for (Vec3& n : w.vertex_normal) n.normalize();
}

void find_edges(WorkMesh& w) {
  w.at_border.assign(w.mesh.faces.size(), 0);
  w.edges.reserve(w.mesh.faces.size() * 3 / 2), w.edge_faces.reserve(w.mesh.faces.size() * 3);
  mesh::for_each_mesh_edge(mesh::sorted_half_edges(w.mesh), [&](auto first, auto last) {
    const int start = int(w.edge_faces.size());
    for (auto e = first; e < last; ++e) w.edge_faces.push_back(e->face);
    if (last - first == 1) w.at_border[first->face] = 1;
    w.edges.push_back({first->low(), first->high(), start, int(w.edge_faces.size())});
  });
}

}  // namespace

double WorkMesh::turn_to(const WorkMesh& other, const Edge& e) const {
  if (e.crossing()) return e.turn;
  double sum = 0;
  for (int k = e.first_face; k < e.end_face; ++k) {
    const Near& near = face_near[edge_faces[k]];
    sum += near.face >= 0 ? 1 - normal[edge_faces[k]].dot(other.normal[near.face]) : 1;
  }
  return sum / (e.end_face - e.first_face);
}

WorkMesh make_work_mesh(const Model& model, const Box& volume, const std::vector<Territory>& forced,
                        const std::vector<SplitPoint>& points, const std::vector<SplitSegment>& segments) {
  WorkMesh w;
  Mesh plain;
  plain.vertices = model.prepared.mesh.vertices, plain.faces = model.prepared.mesh.faces;
  SplitMesh split = split_faces(plain, points, std::vector<char>(points.size(), 1), segments);
  w.mesh = std::move(split.mesh), w.source = std::move(split.source), w.vertex_of = std::move(split.vertex_of);
  measure(w);
  find_edges(w);
  w.forced.resize(w.mesh.faces.size()), w.whole.resize(w.mesh.faces.size());
  w.twin.assign(w.mesh.faces.size(), -1);
  for (int f = 0; f < w.mesh.face_count(); ++f) {
    w.forced[f] = forced[w.source[f]];
    w.whole[f] = !volume.contains(model.prepared.mesh.face_box(w.source[f]));
  }
  w.face_near.resize(w.mesh.faces.size()), w.vertex_near.resize(w.mesh.vertices.size());
  w.tree = std::make_unique<spatial::FaceTree>(w.mesh);
  return w;
}

void look_nearby(WorkMesh& mine, const WorkMesh& other, double reach, int threads) {
  const Mesh& m = mine.mesh;
  const auto look = [&](WorkMesh::Near& near, const Vec3& p) {
    if (near.distance < 1e300) return false;
    const spatial::FaceTree::Hit hit = other.tree->nearest(p, reach);
    if (hit.face >= 0) near.face = hit.face, near.point = hit.point, near.distance = hit.distance;
    return hit.face >= 0;
  };
  parallel_for(m.face_count(), threads, [&](long begin, long end) {
    for (int f = int(begin); f < end; ++f) {
      WorkMesh::Near& near = mine.face_near[f];
      const Vec3 p = m.center(f);
      if (mine.forced[f] || !look(near, p)) continue;
      near.beside = beside_border(other, near, p);
      near.opposite = other.normal[near.face].dot(mine.normal[f]) <= kAgree;
      if (near.opposite) near.face = -1;
    }
  });
  std::vector<char> asked(m.vertices.size(), 0);
  for (int f = 0; f < m.face_count(); ++f)
    if (!mine.forced[f])
      for (int v : m.faces[f]) asked[v] = 1;
  parallel_for(m.vertex_count(), threads, [&](long begin, long end) {
    for (int v = int(begin); v < end; ++v) {
      WorkMesh::Near& near = mine.vertex_near[v];
      if (!asked[v] || !look(near, m.vertices[v])) continue;
      near.beside = beside_border(other, near, m.vertices[v]);
      near.opposite = other.normal[near.face].dot(mine.vertex_normal[v]) <= kOpposite;
      if (near.opposite) near.face = -1;
    }
  });
}

}  // namespace parts::cut
