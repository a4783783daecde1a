// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "parts/compose/compose.h"
#include "parts/mesh/self_intersections.h"
#include "parts/mesh/topology.h"
#include "support/shapes.h"

namespace parts::test {

/// A face's three positions, bit for bit, from its least corner on.
using FaceKey = std::array<double, 9>;

inline FaceKey face_key(const Mesh& mesh, int face, bool turned = false) {
  FaceKey least{};
  for (int first = 0; first < 3; ++first) {
    FaceKey key;
    for (int k = 0; k < 3; ++k)
      for (int d = 0; d < 3; ++d) key[3 * k + d] = mesh.corner(face, (first + (turned ? 3 - k : k)) % 3)[d];
    if (first == 0 || key < least) least = key;
  }
  return least;
}

inline std::set<FaceKey> face_keys(const Mesh& mesh, bool turned = false) {
  std::set<FaceKey> keys;
  for (int f = 0; f < mesh.face_count(); ++f) keys.insert(face_key(mesh, f, turned));
  return keys;
}

inline double volume_of(const Mesh& mesh) {
  double sum = 0;
  for (int f = 0; f < mesh.face_count(); ++f) sum += mesh.corner(f, 0).dot(mesh.corner(f, 1).cross(mesh.corner(f, 2)));
  return sum / 6;
}

inline compose::ComposeResult compose_quietly(const cut::Part& a, const cut::Part& b,
                                              const compose::ComposeOptions& options = {}) {
  Progress silent;
  return compose::compose(a, b, options, silent);
}

/// The sentence of the UserError that a call throws; empty if it throws none.
template <class Call>
std::string user_error(const Call& call) {
  try {
    call();
  } catch (const UserError& e) {
    return e.what();
  }
  return {};
}

inline void expect_closed_manifold(const Mesh& mesh, const std::string& what) {
  const mesh::MeshCheck c = mesh::check(mesh);
  EXPECT_TRUE(c.closed() && c.manifold() && c.oriented()) << what << "\n" << mesh::to_string(c);
  EXPECT_EQ(c.nonfinite_vertices + c.unused_vertices, 0) << what;
  EXPECT_GT(c.faces, 0) << what;
}

/// Faces that must survive and are not in the result.
inline int missing_faces(const compose::ComposeResult& r, const cut::Part& a, const cut::Part& b) {
  const std::set<FaceKey> result = face_keys(r.composed);
  int missing = 0;
  for (int f = 0; f < a.mesh.face_count(); ++f) missing += a.keep[f] && !result.count(face_key(a.mesh, f));
  for (int f = 0; f < b.mesh.face_count(); ++f)
    missing += b.keep[f] && !result.count(face_key(b.mesh, f, r.report.reversed_b));
  return missing;
}

inline double longest_edge(const Mesh& mesh) {
  double longest = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (mesh.corner(f, k) - mesh.corner(f, (k + 1) % 3)).norm());
  return longest;
}

/// Faces that are of no input, bit for bit, and whose every corner is farther
/// than `distance` from the clipped models' borders.
inline int changed_far_faces(const compose::ComposeResult& r, const Mesh& a, const Mesh& b, double distance) {
  std::vector<Vec3> seam;
  for (const Mesh* clipped : {&r.clipped_a, &r.clipped_b})
    for (const auto& loop : mesh::boundary_loops(*clipped, mesh::edge_map(*clipped)))
      for (int v : loop) seam.push_back(clipped->vertices[v]);
  const std::set<FaceKey> of_a = face_keys(a), of_b = face_keys(b, r.report.reversed_b);
  int changed = 0;
  for (int f = 0; f < r.composed.face_count(); ++f) {
    if (r.face_from_b[f] == 2) continue;
    if ((r.face_from_b[f] == 1 ? of_b : of_a).count(face_key(r.composed, f))) continue;
    bool near = false;
    for (const Vec3& s : seam)
      for (int k = 0; k < 3 && !near; ++k) near = (s - r.composed.corner(f, k)).norm() <= distance;
    changed += !near;
  }
  return changed;
}

/// Two spheres of radius 1 around (0, 0, 0) and (1, 0, 0), their far ends kept.
inline std::array<cut::Part, 2> two_spheres(int subdivisions = 3) {
  cut::Part a{sphere({0, 0, 0}, 1, subdivisions), {}}, b{sphere({1, 0, 0}, 1, subdivisions), {}};
  a.keep = faces_where(a.mesh, [](const Vec3& c) { return c.x() < -0.7; });
  b.keep = faces_where(b.mesh, [](const Vec3& c) { return c.x() > 1.7; });
  return {a, b};
}

}  // namespace parts::test
