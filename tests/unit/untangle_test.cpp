// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/untangle.h"

#include "compose_support.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/pinches.h"

namespace parts::test {
namespace {

/// A flat grid of n x n vertices at height 0.
Mesh sheet(int n) {
  Mesh m;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) m.vertices.push_back({double(i), double(j), 0});
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const int v = j * n + i;
      m.faces.push_back({v, v + 1, v + n});
      m.faces.push_back({v + 1, v + n + 1, v + n});
    }
  return m;
}

/// All is seam.
std::size_t untangled(Mesh& m, const std::vector<char>& movable) {
  const std::vector<Vec3> before = m.vertices;
  const std::vector<char> seam(m.vertices.size(), 1), tag(m.faces.size(), 0);
  return seam::untangle(m, {movable, seam, tag, before, 10}).size();
}

TEST(Untangle, PartsFacesThatCross) {
  Mesh m = sheet(9);
  const Mesh flat = m;
  m.vertices[4 * 9 + 4] += Vec3(2.6, 0.3, 0);
  ASSERT_GT(mesh::self_intersections(m), 0);
  std::vector<char> movable(m.vertices.size(), 0);
  for (int j = 3; j < 6; ++j)
    for (int i = 3; i < 7; ++i) movable[j * 9 + i] = 1;
  EXPECT_EQ(untangled(m, movable), 0u);
  EXPECT_EQ(mesh::self_intersections(m), 0);
  for (std::size_t v = 0; v < movable.size(); ++v) EXPECT_TRUE(movable[v] || m.vertices[v] == flat.vertices[v]) << v;
}

TEST(Untangle, LeavesACleanSurfaceAndWhatMayNotMove) {
  Mesh m = sheet(6);
  const std::vector<Vec3> before = m.vertices;
  EXPECT_EQ(untangled(m, std::vector<char>(m.vertices.size(), 1)), 0u);
  EXPECT_EQ(m.vertices, before);
  m.vertices[2 * 6 + 2] += Vec3(1.7, 0.1, 0);
  ASSERT_GT(mesh::self_intersections(m), 0);
  const std::vector<Vec3> crossing = m.vertices;
  EXPECT_EQ(untangled(m, std::vector<char>(m.vertices.size(), 0)), 0u);  // none of them is movable
  EXPECT_EQ(m.vertices, crossing);
}

int folds_of(const Mesh& m) {
  int folds = 0;
  mesh::for_each_mesh_edge(mesh::sorted_half_edges(m), [&](auto first, auto last) {
    folds += last - first == 2 && m.normal(first->face).dot(m.normal(first[1].face)) < -0.34;
  });
  return folds;
}

TEST(Untangle, OpensFoldsOfAnySheet) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    Mesh m = sheet(12);
    for (Vec3& v : m.vertices) v.z() = 0.4 * std::sin(0.5 * v.x() + seed) + 0.05 * random.uniform(-1, 1);
    // A spike that leans over, without a crossing.
    const int v = (3 + random.below(6)) * 12 + 3 + random.below(6);
    m.vertices[v] += Vec3(random.uniform(1.2, 1.6), random.uniform(-0.2, 0.2), random.uniform(0.3, 0.5));
    if (folds_of(m) == 0) continue;
    std::vector<char> movable(m.vertices.size(), 0);
    for (int j = 2; j < 10; ++j)
      for (int i = 2; i < 10; ++i) movable[j * 12 + i] = 1;
    EXPECT_EQ(untangled(m, movable), 0u) << seed;
    EXPECT_EQ(folds_of(m), 0) << seed;
    EXPECT_EQ(mesh::self_intersections(m), 0) << seed;
  }
}

TEST(Untangle, WhatTheInputsHadAwayFromTheSeamIsLeft) {
  Mesh m = sheet(12);
  m.vertices[2 * 12 + 2] += Vec3(1.7, 0.1, 0);  // an input's own crossing
  const std::vector<Vec3> before = m.vertices;
  m.vertices[8 * 12 + 8] += Vec3(1.7, 0.1, 0);  // made at the seam
  std::vector<char> seam(m.vertices.size(), 0), movable(m.vertices.size(), 1);
  for (int i = 0; i < 12; ++i) seam[8 * 12 + i] = 1;
  const std::vector<char> tag(m.faces.size(), 0);
  EXPECT_TRUE(seam::untangle(m, {movable, seam, tag, before, 10}).empty());
  EXPECT_EQ(m.vertices[2 * 12 + 2], before[2 * 12 + 2]);
  EXPECT_GT(mesh::self_intersections(m), 0);
  EXPECT_NE(m.vertices[8 * 12 + 8], before[8 * 12 + 8] + Vec3(1.7, 0.1, 0));
}

TEST(SplitPinches, EachFanGetsAVertexOfItsOwn) {
  // Two tetrahedra that share one vertex.
  Mesh m;
  m.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  m.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
  ASSERT_EQ(mesh::check(m).nonmanifold_vertices, 1);
  std::vector<char> asked(7, 0);
  EXPECT_TRUE(mesh::split_pinches(m, asked).empty());
  EXPECT_EQ(mesh::check(m).nonmanifold_vertices, 1);
  asked[0] = 1;
  EXPECT_EQ(mesh::split_pinches(m, asked), std::vector<int>{0});
  EXPECT_EQ(mesh::check(m).nonmanifold_vertices, 0);
  ASSERT_EQ(m.vertex_count(), 8);
  EXPECT_EQ(m.vertices[7], m.vertices[0]);
}

}  // namespace
}  // namespace parts::test
