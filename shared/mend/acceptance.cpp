// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/acceptance.h"

#include <algorithm>
#include <set>

#include "parts/mesh/attributes.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/prepare.h"
#include "parts/mesh/self_intersections.h"
#include "parts/mesh/topology.h"
#include "parts/spatial/closest_face.h"

namespace parts::mend {
namespace {

using Place = std::array<double, 3>;
Place place(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// A mesh as a file holds it, and where it is open or no manifold.
struct Welded {
  Mesh mesh;
  mesh::EdgeMap map;
  std::set<mesh::EdgePlace> open;
  std::set<Place> border, bad;  ///< vertices

  explicit Welded(const Mesh& m) : mesh(mesh::welded(m)), map(mesh::edge_map(mesh)) {
    for (int h = 0; h < int(map.mate.size()); ++h) {
      if (map.mate[h] != mesh::EdgeMap::kBoundary) continue;
      const int a = mesh.faces[h / 3][h % 3], b = mesh.faces[h / 3][(h % 3 + 1) % 3];
      open.insert(mesh::edge_place(mesh, a, b));
      border.insert(place(mesh.vertices[a])), border.insert(place(mesh.vertices[b]));
    }
    const std::vector<char> flags = mesh::nonmanifold_vertices(mesh, map);
    for (int v = 0; v < mesh.vertex_count(); ++v)
      if (flags[v]) bad.insert(place(mesh.vertices[v]));
  }
};

bool all_closed(const Trial& t, const Welded& before, const Welded& after) {
  std::set<mesh::EdgePlace> allowed = before.open;
  for (const mesh::Loop& rim : t.rims)
    for (int i = 0; i < rim.size(); ++i) allowed.erase(mesh::edge_place(t.before, rim.vertices[i], rim.next(i)));
  return std::includes(allowed.begin(), allowed.end(), after.open.begin(), after.open.end());
}

/// Where a rim touches itself or another, it is a pinch as long as it is open; then no more.
bool as_manifold(const Trial& t, const Welded& before, const Welded& after) {
  std::set<Place> rims;
  for (const mesh::Loop& rim : t.rims)
    for (int v : rim) rims.insert(place(t.before.vertices[v]));
  return std::all_of(after.bad.begin(), after.bad.end(), [&](const Place& p) {
    return before.bad.count(p) > 0 && (!rims.count(p) || after.border.count(p) > 0);
  });
}

/// A few faces of the stitch, where scan and model differ at the rim, may lie
/// somewhat farther off.
bool near_model(const Trial& t) {
  constexpr double kFarthest = 3, kShare = 0.05;
  const spatial::ClosestFace on_model(t.model);
  double area = 0, off = 0;
  int hint = 0;
  for (int f = 0; f < t.after.face_count(); ++f) {
    if (t.source[f] >= 0) continue;
    const double distance = on_model(t.after.center(f), hint).distance;
    if (distance > kFarthest * t.near) return false;
    area += t.after.area(f);
    if (distance > t.near) off += t.after.area(f);
  }
  return off <= kShare * area;
}

bool clear_of_scan(const Trial& t) {
  Box patch;
  for (int f = 0; f < t.after.face_count(); ++f)
    if (t.source[f] < 0) patch.extend(t.after.face_box(f));
  std::vector<char> around(t.after.faces.size());
  for (int f = 0; f < t.after.face_count(); ++f) around[f] = patch.intersects(t.after.face_box(f));
  std::vector<int> old_face;
  const Mesh there = mesh::take_faces(t.after, around, nullptr, &old_face);
  const auto tolerated = [&](int source) { return !t.crossed.empty() && t.crossed[source]; };
  for (const auto& [f, g] : mesh::intersecting_faces(there, 0, t.threads)) {
    const int a = t.source[old_face[f]], b = t.source[old_face[g]];
    if ((a < 0) != (b < 0) && !tolerated(std::max(a, b))) return false;
  }
  return true;
}

}  // namespace

const char* words(Objection objection) {
  switch (objection) {
    case Objection::NoSurface:
      return "the models have no surface that continues it";
    case Objection::Open:
      return "what the models have there does not close it";
    case Objection::NonManifold:
      return "the patches would touch the scan where they must not";
    case Objection::FarFromModel:
      return "the patches would lie off the models";
    case Objection::Crosses:
      return "the patches would cross the scan";
    case Objection::Unlike:
      return "a smooth surface goes better with the scan around it";
    case Objection::None:
      break;
  }
  return "";
}

Objection objection_to(const Trial& trial) {
  const Welded before(trial.before), after(trial.after);
  if (!all_closed(trial, before, after)) return Objection::Open;
  if (!as_manifold(trial, before, after)) return Objection::NonManifold;
  if (!near_model(trial)) return Objection::FarFromModel;
  if (!clear_of_scan(trial)) return Objection::Crosses;
  return Objection::None;
}

}  // namespace parts::mend
