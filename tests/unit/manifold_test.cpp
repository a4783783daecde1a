// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/manifold.h"

#include <gtest/gtest.h>

#include "compose_support.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/prepare.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

TEST(Manifold, BoxesThatShareAnEdgeArePartedAndStayClosed) {
  const Mesh both =
      mesh::prepare(together({box(Vec3(0, 0, 0), Vec3(1, 1, 1), 3), box(Vec3(1, 1, 0), Vec3(2, 2, 1), 3)})).mesh;
  ASSERT_GT(mesh::check(mesh::welded(both)).nonmanifold_edges, 0);
  const Mesh parted = mesh::made_manifold(both);
  const mesh::MeshCheck check = mesh::check(mesh::welded(parted));
  EXPECT_EQ(check.nonmanifold_edges, 0);
  EXPECT_EQ(check.nonmanifold_vertices, 0);
  EXPECT_EQ(check.boundary_loops, 0);
  for (const Vec3& v : parted.vertices) EXPECT_LT(Box(Vec3(0, 0, 0), Vec3(2, 2, 1)).exteriorDistance(v), 1e-9);
}

TEST(Manifold, FlapsGoAndTheSurfaceStays) {
  const Mesh whole = sphere();
  Mesh flapped = whole;
  const auto& v = whole.vertices;
  flapped.vertices.push_back(1.2 * v[std::size_t(whole.faces[7][0])]);
  flapped.vertices.push_back(1.3 * v[std::size_t(whole.faces[7][1])]);
  const int a = whole.vertex_count(), b = a + 1;
  flapped.faces.push_back({whole.faces[7][0], whole.faces[7][1], a});
  flapped.faces.push_back({a, whole.faces[7][1], b});
  const Mesh mended = mesh::made_manifold(flapped);
  EXPECT_EQ(mended.face_count(), whole.face_count() + 1);  // what hung on the flap is by itself
  EXPECT_EQ(mesh::check(mended).nonmanifold_edges, 0);
  const std::vector<int> component = mesh::vertex_components(mended);
  expect_closed_manifold(mesh::take_faces(mended,
                                          [&] {
                                            std::vector<char> flags;
                                            for (const Triangle& f : mended.faces)
                                              flags.push_back(component[f[0]] == component[0]);
                                            return flags;
                                          }()),
                         "sphere");
}

TEST(Manifold, WhatIsManifoldStaysBitForBit) {
  const Mesh mesh = mesh::take_faces(
      noisy_sphere(Vec3::Zero(), 1, 3, 0.2, 4),
      faces_where(noisy_sphere(Vec3::Zero(), 1, 3, 0.2, 4), [](const Vec3& p) { return p.z() < 0.7; }));
  const Mesh same = mesh::made_manifold(mesh);
  EXPECT_EQ(same.vertices, mesh.vertices);
  EXPECT_EQ(same.faces, mesh.faces);
}

}  // namespace
}  // namespace parts::test
