// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/untangle.h"

#include "compose_support.h"
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

TEST(Untangle, PartsFacesThatCross) {
  Mesh m = sheet(9);
  const Mesh flat = m;
  m.vertices[4 * 9 + 4] += Vec3(2.6, 0.3, 0);
  ASSERT_GT(mesh::self_intersections(m), 0);
  std::vector<char> movable(m.vertices.size(), 0);
  for (int j = 3; j < 6; ++j)
    for (int i = 3; i < 7; ++i) movable[j * 9 + i] = 1;
  EXPECT_EQ(seam::untangle(m, movable, 15, 1), 0);
  EXPECT_EQ(mesh::self_intersections(m), 0);
  for (std::size_t v = 0; v < movable.size(); ++v) EXPECT_TRUE(movable[v] || m.vertices[v] == flat.vertices[v]) << v;
}

TEST(Untangle, LeavesACleanSurfaceAndWhatMayNotMove) {
  Mesh m = sheet(6);
  const std::vector<Vec3> before = m.vertices;
  EXPECT_EQ(seam::untangle(m, std::vector<char>(m.vertices.size(), 1), 15, 1), 0);
  EXPECT_EQ(m.vertices, before);
  m.vertices[2 * 6 + 2] += Vec3(1.7, 0.1, 0);
  ASSERT_GT(mesh::self_intersections(m), 0);
  const std::vector<Vec3> crossing = m.vertices;
  EXPECT_EQ(seam::untangle(m, std::vector<char>(m.vertices.size(), 0), 15, 1), 0);  // none of them is movable
  EXPECT_EQ(m.vertices, crossing);
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
