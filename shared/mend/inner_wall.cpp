// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/inner_wall.h"

#include <algorithm>
#include <numeric>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/edges.h"

namespace parts::mend {
namespace {

/// Twice the area that a loop encloses, along the normal of a surface in it.
Vec3 area_vector(const Mesh& mesh, const mesh::Loop& loop) {
  Vec3 sum = Vec3::Zero();
  const Vec3& start = mesh.vertices[loop.vertices[0]];
  for (int i = 0; i < loop.size(); ++i)
    sum += (mesh.vertices[loop.next(i)] - start).cross(mesh.vertices[loop.vertices[i]] - start);
  return sum;
}

/// Faces in the box that hang together by edges with those at the rim.
std::vector<char> wall_of(const Mesh& mesh, const mesh::Loop& rim, const Box& box) {
  std::vector<char> inside(mesh.faces.size());
  for (int f = 0; f < mesh.face_count(); ++f) inside[f] = box.intersects(mesh.face_box(f));
  DisjointSets pieces(mesh.face_count());
  mesh::for_each_mesh_edge(mesh::sorted_half_edges(mesh), [&](auto first, auto last) {
    for (auto e = first + 1; e < last; ++e)
      if (inside[first->face] && inside[e->face]) pieces.unite(first->face, e->face);
  });
  std::vector<char> at_rim(mesh.vertices.size(), 0), wanted(mesh.faces.size(), 0);
  for (int v : rim) at_rim[v] = 1;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f])
      if (inside[f] && at_rim[v]) wanted[pieces.find(f)] = 1;
  for (int f = 0; f < mesh.face_count(); ++f) inside[f] = inside[f] && wanted[pieces.find(f)];
  return inside;
}

bool holds_any(const Mesh& mesh, const std::vector<Vec3>& places) {
  return std::any_of(mesh.vertices.begin(), mesh.vertices.end(),
                     [&](const Vec3& v) { return std::find(places.begin(), places.end(), v) != places.end(); });
}

}  // namespace

std::vector<Vec3> rim_in_other_wall(const Scan& scan, const Region& region) {
  std::vector<Vec3> places;
  if (region.rims.size() != 1) return places;
  const Mesh& mesh = scan.mesh();
  const Vec3 own = area_vector(mesh, region.rims[0]);
  const double length = mesh::loop_length(mesh, region.rims[0]);
  for (const mesh::Loop& rim : scan.rims()) {
    const Vec3 other = area_vector(mesh, rim);
    const double ratio = mesh::loop_length(mesh, rim) / length;
    const bool inside =
        std::all_of(rim.begin(), rim.end(), [&](int v) { return region.box.contains(mesh.vertices[v]); });
    if (!inside || ratio < 0.5 || ratio > 2 || own.dot(other) > -0.7 * own.norm() * other.norm()) continue;
    for (int v : rim) places.push_back(mesh.vertices[v]);
  }
  return places;
}

std::optional<InnerWall> inner_wall(const Scan& scan, const Region& region, const std::vector<Vec3>& other) {
  std::vector<int> old_vertex, old_face;
  Mesh mesh;
  for (double share : {2 * kAround, kAround, 0.4, 0.2, 0.0}) {
    mesh = mesh::take_faces(scan.mesh(), wall_of(scan.mesh(), region.rims[0], around(region, share)), &old_vertex,
                            &old_face);
    if (!holds_any(mesh, other)) break;
    mesh = {};
  }
  if (mesh.faces.empty()) return {};
  mesh::flip_orientation(mesh);
  std::vector<int> origin(mesh.faces.size());
  std::iota(origin.begin(), origin.end(), 0);
  InnerWall wall{Scan(std::move(mesh), std::move(origin)), region, std::move(old_vertex), std::move(old_face)};
  std::vector<int> asked(region.rims[0].begin(), region.rims[0].end());
  std::sort(asked.begin(), asked.end());
  for (const mesh::Loop& rim : wall.scan.rims())
    if (std::all_of(rim.begin(), rim.end(),
                    [&](int v) { return std::binary_search(asked.begin(), asked.end(), wall.old_vertex[v]); })) {
      wall.region.rims = {rim};
      return wall;
    }
  return {};
}

Restored put_back(const Scan& scan, const InnerWall& wall, Restored r) {
  // Which of the wall's faces are left, and which of the scan's vertices those of the result are.
  std::vector<char> stays(scan.mesh().faces.size(), 1), is_new;
  for (int f : wall.old_face) stays[f] = 0;
  std::vector<int> vertex(r.mesh.vertices.size(), -1);
  for (int f = 0; f < r.mesh.face_count(); ++f) {
    is_new.push_back(r.source[f] < 0);
    if (r.source[f] < 0) continue;
    stays[wall.old_face[r.source[f]]] = 1;
    for (int k = 0; k < 3; ++k) vertex[r.mesh.faces[f][k]] = wall.old_vertex[wall.scan.mesh().faces[r.source[f]][k]];
  }
  std::vector<int> patch_vertex, patch_face, whole_vertex, whole_face;
  Mesh patch = mesh::take_faces(r.mesh, is_new, &patch_vertex, &patch_face);
  mesh::flip_orientation(patch), mesh::flip_orientation(r.candidate);
  Mesh whole = scan.mesh();
  const int first_vertex = whole.vertex_count(), first_face = whole.face_count();
  mesh::append(whole, patch);
  for (int f = first_face; f < whole.face_count(); ++f)
    for (int& v : whole.faces[f])
      if (const int own = vertex[patch_vertex[v - first_vertex]]; own >= 0) v = own;
  stays.resize(whole.faces.size(), 1);
  Restored out;
  out.mesh = mesh::take_faces(whole, stays, &whole_vertex, &whole_face);
  for (int f : whole_face) out.source.push_back(f < first_face ? f : r.source[patch_face[f - first_face]]);
  out.candidate = std::move(r.candidate), out.report = r.report;
  return out;
}

}  // namespace parts::mend
