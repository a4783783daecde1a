// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/stitch.h"

#include "parts/seam/cap.h"
#include "parts/seam/pieces.h"
#include "unit/compose_support.h"

namespace parts::test {
namespace {

/// A cup: a ring of n vertices at height z and a fan to its tip. Its boundary
/// loop faces the other cup's when `up` differs.
void add_cup(Mesh& mesh, int n, double z, bool up, const Vec3& center = Vec3::Zero(), double radius = 1,
             double turn = 0) {
  const int first = mesh.vertex_count();
  for (int i = 0; i < n; ++i) {
    const double u = 2 * M_PI * (i + turn) / n;
    mesh.vertices.push_back(center + Vec3(radius * std::cos(u), radius * std::sin(u), z));
  }
  mesh.vertices.push_back(center + Vec3(0, 0, z + (up ? 1 : -1)));
  for (int i = 0; i < n; ++i) {
    const int a = first + i, b = first + (i + 1) % n;
    mesh.faces.push_back(up ? Triangle{a, b, first + n} : Triangle{b, a, first + n});
  }
}

std::vector<int> faces_at_vertices(const Mesh& mesh) {
  std::vector<int> like(mesh.vertices.size(), -1);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f]) like[v] = f;
  return like;
}

std::vector<mesh::Loop> boundary(const Mesh& mesh) { return mesh::trace_loops(mesh::boundary_half_edges(mesh)); }

std::vector<mesh::Loop> loops_where(const Mesh& mesh, const std::function<bool(const Vec3&)>& pass) {
  std::vector<mesh::Loop> found;
  for (const mesh::Loop& l : boundary(mesh))
    if (pass(mesh.vertices[l.vertices[0]])) found.push_back(l);
  return found;
}
std::vector<mesh::Loop> upper(const Mesh& mesh) {
  return loops_where(mesh, [](const Vec3& v) { return v.z() > 0; });
}
std::vector<mesh::Loop> lower(const Mesh& mesh) {
  return loops_where(mesh, [](const Vec3& v) { return v.z() < 0; });
}

TEST(TraceLoops, EveryHalfEdgeOnce) {
  const std::vector<mesh::Loop> two = mesh::trace_loops({{0, 1}, {5, 6}, {1, 2}, {6, 5}, {2, 0}});
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].vertices, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(two[1].vertices, (std::vector<int>{5, 6}));
  // A chain between two ends of an open surface.
  const std::vector<mesh::Loop> chain = mesh::trace_loops({{3, 4}, {2, 3}, {4, 9}});
  ASSERT_EQ(chain.size(), 1u);
  EXPECT_FALSE(chain[0].closed);
  EXPECT_EQ(chain[0].vertices, (std::vector<int>{2, 3, 4, 9}));
  // A figure of eight through vertex 0: however it is taken, all six are used.
  int length = 0;
  for (const mesh::Loop& l : mesh::trace_loops({{0, 1}, {1, 2}, {2, 0}, {0, 3}, {3, 4}, {4, 0}})) length += l.size();
  EXPECT_EQ(length, 6);
  EXPECT_TRUE(mesh::trace_loops({}).empty());
}

TEST(Zipper, ClosesTwoRingsOfDifferentSizes) {
  for (const auto& [n, m] : std::vector<std::array<int, 2>>{{12, 12}, {5, 40}, {40, 5}, {3, 3}, {3, 200}, {700, 650}})
    for (const double turn : {0.0, 0.3, 0.77}) {
      Mesh mesh;
      add_cup(mesh, n, 0.1, true);
      add_cup(mesh, m, -0.1, false, {0.05, 0, 0}, 1, turn * m);
      const std::vector<mesh::Loop> a = upper(mesh), b = lower(mesh);
      ASSERT_EQ(a.size(), 1u);
      ASSERT_EQ(b.size(), 1u);
      EXPECT_LT(seam::direction_agreement(mesh, a[0], b[0]), -0.5);
      seam::zipper(mesh, a[0], b[0], faces_at_vertices(mesh));
      expect_closed_manifold(mesh, std::to_string(n) + " to " + std::to_string(m));
      EXPECT_EQ(mesh::check(mesh).components, 1);
      EXPECT_EQ(mesh::self_intersections(mesh), 0) << n << " to " << m;
    }
}

TEST(Zipper, NeverUsesACrossEdgeTwice) {
  // A small ring off one side of a large one: the shortest strip runs along one
  // whole ring before it moves on the other.
  for (const double offset : {0.0, 0.5, 1.0, 3.0})
    for (const int n : {3, 4, 6, 20}) {
      Mesh mesh;
      add_cup(mesh, n, 0.01, true, {offset, 0, 0}, 0.05);
      add_cup(mesh, 30, -0.01, false);
      seam::zipper(mesh, upper(mesh)[0], lower(mesh)[0], faces_at_vertices(mesh));
      expect_closed_manifold(mesh, "offset " + std::to_string(offset));
    }
}

TEST(Zipper, CoincidentRingsGiveNoHole) {
  Mesh mesh;
  add_cup(mesh, 24, 0, true);
  add_cup(mesh, 24, 0, false);
  const std::vector<mesh::Loop> loops = boundary(mesh);
  ASSERT_EQ(loops.size(), 2u);
  seam::zipper(mesh, loops[0], loops[1], faces_at_vertices(mesh));
  expect_closed_manifold(mesh, "coincident");
}

TEST(DirectionAgreement, TellsWhichWayContoursRun) {
  Mesh mesh;
  add_cup(mesh, 30, 0.1, true);
  add_cup(mesh, 47, -0.1, true);  // both cups up: both contours run the same way
  EXPECT_GT(seam::direction_agreement(mesh, upper(mesh)[0], lower(mesh)[0]), 0.9);
}

TEST(ZipperPieces, OneContourFacesTwo) {
  // Below a long slot whose middle is pinched; above two rings side by side.
  Mesh mesh;
  add_cup(mesh, 24, 0.05, true, {-1.05, 0, 0});
  add_cup(mesh, 24, 0.05, true, {1.05, 0, 0});
  const int first = mesh.vertex_count(), n = 80;
  for (int i = 0; i < n; ++i) {
    const double u = 2 * M_PI * i / n, x = 2.05 * std::cos(u), waist = 0.15 + 0.85 * std::min(1.0, std::abs(x));
    mesh.vertices.emplace_back(x, waist * std::sin(u), -0.05);
  }
  mesh.vertices.emplace_back(0, 0, -1);
  for (int i = 0; i < n; ++i) mesh.faces.push_back({first + (i + 1) % n, first + i, first + n});
  const std::vector<int> like = faces_at_vertices(mesh);
  const std::vector<mesh::Loop> a = upper(mesh), b = lower(mesh);
  ASSERT_EQ(a.size(), 2u);
  ASSERT_EQ(b.size(), 1u);
  const int before = mesh.face_count();
  const std::vector<mesh::Loop> rest = seam::zipper_pieces(mesh, a, b, 0.5, like).open;
  EXPECT_GT(mesh.face_count(), before + 40);
  const mesh::MeshCheck c = mesh::check(mesh);
  EXPECT_EQ(c.nonmanifold_edges + c.inconsistent_edges, 0) << mesh::to_string(c);
  // What is left open is just the boundary that is left.
  std::set<std::array<int, 2>> left, said;
  for (const auto& e : mesh::boundary_half_edges(mesh)) left.insert(e);
  for (const mesh::Loop& l : rest) {
    EXPECT_TRUE(l.closed);
    for (int i = 0; i < l.size(); ++i) said.insert({l.vertices[i], l.vertices[(i + 1) % l.size()]});
  }
  EXPECT_EQ(said, left);
  for (const mesh::Loop& l : rest) seam::cap(mesh, l, like);
  EXPECT_TRUE(mesh::check(mesh).closed() && mesh::check(mesh).oriented());
}

TEST(ZipperPieces, NothingToFaceLeavesAllOpen) {
  Mesh mesh;
  add_cup(mesh, 12, 0.1, true);
  const std::vector<mesh::Loop> rest = seam::zipper_pieces(mesh, boundary(mesh), {}, 1, faces_at_vertices(mesh)).open;
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_EQ(rest[0].size(), 12);
  EXPECT_EQ(mesh.face_count(), 12);
}

TEST(Cap, ClosesContoursOfAnyShape) {
  Random random(3);
  for (int n = 3; n < 40; n += 3) {
    Mesh mesh;
    add_cup(mesh, n, 0, true);
    for (int i = 0; i < n; ++i) mesh.vertices[i] *= random.uniform(0.3, 1.5);
    seam::cap(mesh, boundary(mesh)[0], faces_at_vertices(mesh));
    expect_closed_manifold(mesh, std::to_string(n) + " corners");
    EXPECT_EQ(mesh.face_count(), n + n - 2);
  }
}

TEST(MatchLoops, PairsTheNearestWithinTheGap) {
  Mesh mesh;
  for (const double x : {0.0, 5.0, 10.0}) add_cup(mesh, 12, 0.1, true, {x, 0, 0});
  for (const double x : {10.0, 0.0}) add_cup(mesh, 16, -0.1, false, {x, 0, 0});
  const std::vector<mesh::Loop> a = upper(mesh), b = lower(mesh);
  double gap = 0;
  const auto pairs = mesh::match_loops(mesh, a, b, 0.5, gap);
  ASSERT_EQ(pairs.size(), 2u);
  for (const auto& [i, j] : pairs)
    EXPECT_LT((mesh.vertices[a[i].vertices[0]] - mesh.vertices[b[j].vertices[0]]).norm(), 3);
  EXPECT_GT(gap, 0.19);
  EXPECT_LT(gap, 0.35);
  EXPECT_TRUE(mesh::match_loops(mesh, a, b, 0.1, gap).empty());
  EXPECT_EQ(gap, 0);
}

}  // namespace
}  // namespace parts::test
