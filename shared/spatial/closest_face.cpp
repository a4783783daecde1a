// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/spatial/closest_face.h"

#include "parts/mesh/edges.h"

namespace parts::spatial {

ClosestFace::ClosestFace(const Mesh& mesh, const std::vector<char>& flags) : mesh_(mesh) {
  const auto belongs = [&](int f) { return flags.empty() || flags[f]; };
  Surface surface;
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!belongs(f)) continue;
    const Vec3 n = (mesh.corner(f, 1) - mesh.corner(f, 0)).cross(mesh.corner(f, 2) - mesh.corner(f, 0)).normalized();
    if (!(n.squaredNorm() > 0.5)) continue;
    surface.triangles.push_back({mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)});
    surface.normals.push_back(n);
    face_.push_back(f);
  }
  if (face_.empty()) return;
  tree_ = std::make_unique<TriangleTree>(surface);
  border_edge_.assign(mesh.faces.size(), {false, false, false});
  border_vertex_.assign(mesh.vertices.size(), 0);
  mesh::for_each_mesh_edge(mesh::sorted_half_edges(mesh), [&](auto first, auto last) {
    int count = 0;
    for (auto e = first; e < last; ++e) count += belongs(e->face);
    if (count != 1) return;
    for (auto e = first; e < last; ++e) {
      if (!belongs(e->face)) continue;
      for (int k = 0; k < 3; ++k)
        if (mesh.faces[e->face][k] == e->from && mesh.faces[e->face][(k + 1) % 3] == e->to)
          border_edge_[e->face][k] = true;
      border_vertex_[e->from] = border_vertex_[e->to] = 1;
    }
  });
}

FaceHit ClosestFace::operator()(const Vec3& p, int& hint) const {
  constexpr double kNone = 1e-7;  // barycentric coordinates this small are zero
  const Closest c = tree_->closest(p, hint);
  FaceHit hit;
  hit.face = face_[c.triangle];
  hit.point = c.point, hit.normal = c.normal, hit.distance = (c.point - p).norm();
  const Vec3 &a = mesh_.corner(hit.face, 0), ab = mesh_.corner(hit.face, 1) - a, ac = mesh_.corner(hit.face, 2) - a;
  const Vec3 n = ab.cross(ac), q = c.point - a;
  const double u = q.cross(ac).dot(n) / n.squaredNorm(), v = ab.cross(q).dot(n) / n.squaredNorm();
  hit.barycentric = Vec3(1 - u - v, u, v).cwiseMax(0.0);
  hit.barycentric /= hit.barycentric.sum();
  for (int k = 0; k < 3; ++k) {
    const int opposite = (k + 2) % 3;
    if (hit.barycentric[opposite] <= kNone && border_edge_[hit.face][k]) hit.on_border = true;
    if (hit.barycentric[k] >= 1 - kNone && border_vertex_[mesh_.faces[hit.face][k]]) hit.on_border = true;
  }
  return hit;
}

}  // namespace parts::spatial
