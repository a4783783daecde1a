// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/topology.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/shapes.h"

namespace parts {
namespace {

using namespace parts::test;

void remove_face(Mesh& mesh, int f) { mesh.faces.erase(mesh.faces.begin() + f); }

TEST(Topology, ClosedSurfacesAreClean) {
  const Mesh surfaces[] = {sphere(), torus(), box({0, 0, 0}, {1, 2, 3}, 3)};
  const int euler[] = {2, 0, 2};
  for (int i = 0; i < 3; ++i) {
    const mesh::MeshCheck c = mesh::check(surfaces[i]);
    EXPECT_TRUE(c.manifold() && c.closed() && c.oriented()) << mesh::to_string(c);
    EXPECT_EQ(c.euler, euler[i]);
    EXPECT_EQ(c.components, 1);
    EXPECT_EQ(c.boundary_loops, 0);
    EXPECT_EQ(c.degenerate_faces, 0);
    EXPECT_EQ(c.edges, surfaces[i].face_count() * 3 / 2);
  }
}

TEST(Topology, HolesAreCountedAndTraced) {
  Mesh mesh = sphere(Vec3::Zero(), 1, 3);
  remove_face(mesh, 700);
  remove_face(mesh, 10);
  const mesh::MeshCheck c = mesh::check(mesh);
  EXPECT_EQ(c.boundary_edges, 6);
  EXPECT_EQ(c.boundary_loops, 2);
  EXPECT_EQ(c.euler, 0);
  EXPECT_TRUE(c.manifold());
  for (const mesh::Loop& loop : mesh::boundary_loops(mesh, mesh::edge_map(mesh))) {
    EXPECT_EQ(loop.size(), 3);
    EXPECT_TRUE(loop.closed);
  }
}

// The faces between the two holes make two fans at the vertex, and a border
// follows its fan: it passes the vertex twice.
TEST(Topology, HolesThatTouchAtAVertexMakeOneBorder) {
  Mesh mesh = sphere(Vec3::Zero(), 1, 2);
  // Two faces opposite each other at vertex 0.
  std::vector<int> around;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f])
      if (v == 0) around.push_back(f);
  ASSERT_EQ(around.size(), 5u);
  int other = -1;
  for (int f : around) {
    int common = 0;
    for (int v : mesh.faces[f])
      for (int w : mesh.faces[around[0]]) common += v == w;
    if (common == 1) other = f;
  }
  ASSERT_GE(other, 0);
  remove_face(mesh, std::max(other, around[0]));
  remove_face(mesh, std::min(other, around[0]));
  const mesh::MeshCheck c = mesh::check(mesh);
  EXPECT_EQ(c.boundary_edges, 6);
  EXPECT_EQ(c.boundary_loops, 1);
  EXPECT_EQ(c.nonmanifold_vertices, 1);
  EXPECT_EQ(c.nonmanifold_edges, 0);
}

TEST(Topology, LoopsGoAlongTheFaces) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  const auto loops = mesh::boundary_loops(mesh, mesh::edge_map(mesh));
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].vertices, (std::vector<int>{0, 1, 2, 3}));
}

// A fin of two faces on an inner edge of a sphere: its border begins and ends at
// the edge of three faces, and bounds no hole. Nor does it matter at which of
// its edges the walk begins.
TEST(Topology, BordersThatEndAtNonManifoldEdgesAreChains) {
  for (int turn = 0; turn < 2; ++turn) {
    Mesh mesh = sphere();
    const int a = mesh.faces[0][0], b = mesh.faces[0][1], n = mesh.vertex_count();
    mesh.vertices.push_back(2 * mesh.vertices[a]), mesh.vertices.push_back(2 * mesh.vertices[b]);
    mesh.faces.push_back({a, b, n + 1}), mesh.faces.push_back({a, n + 1, n});
    if (turn) std::swap(mesh.faces[mesh.faces.size() - 1], mesh.faces[mesh.faces.size() - 2]);
    const mesh::EdgeMap map = mesh::edge_map(mesh);
    ASSERT_EQ(map.nonmanifold_edges, 1);
    const auto loops = mesh::boundary_loops(mesh, map);
    ASSERT_EQ(loops.size(), 1u);
    EXPECT_FALSE(loops[0].closed);
    EXPECT_EQ(loops[0].vertices, (std::vector<int>{b, n + 1, n, a}));
    EXPECT_EQ(loops[0].edges(), 3);
  }
}

TEST(Topology, NonManifoldEdgesAndVertices) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  mesh::MeshCheck c = mesh::check(mesh);
  EXPECT_EQ(c.nonmanifold_edges, 1);
  EXPECT_EQ(c.nonmanifold_vertices, 2);
  EXPECT_EQ(c.boundary_edges, 6);
  EXPECT_EQ(c.components, 1);
  const Mesh pair = together({box({0, 0, 0}, {1, 1, 1}), box({2, 0, 0}, {3, 1, 1})});
  EXPECT_EQ(mesh::check(pair).components, 2);
  Mesh joined = pair;  // at one corner
  for (Triangle& f : joined.faces)
    for (int& v : f)
      if (v == 8) v = 0;
  c = mesh::check(joined);
  EXPECT_EQ(c.nonmanifold_vertices, 1);
  EXPECT_EQ(c.nonmanifold_edges, 0);
  EXPECT_EQ(c.unused_vertices, 1);
}

TEST(Topology, FlippedFacesAreInconsistent) {
  Mesh mesh = sphere();
  std::swap(mesh.faces[5][0], mesh.faces[5][1]);
  EXPECT_EQ(mesh::check(mesh).inconsistent_edges, 3);
  EXPECT_TRUE(mesh::check(mesh).manifold());
}

TEST(Topology, DegenerateFaces) {
  Mesh mesh = sphere();
  const mesh::MeshCheck clean = mesh::check(mesh);
  mesh.faces.push_back({3, 3, 4});
  mesh.faces.push_back({5, 5, 5});
  mesh::MeshCheck c = mesh::check(mesh);
  EXPECT_EQ(c.degenerate_faces, 2);
  EXPECT_EQ(c.edges, clean.edges);
  EXPECT_EQ(c.euler, 2);
  EXPECT_TRUE(c.closed() && c.manifold());
  mesh.vertices = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {std::numeric_limits<double>::quiet_NaN(), 0, 0}};
  mesh.faces = {{0, 1, 2}};
  c = mesh::check(mesh);
  EXPECT_EQ(c.degenerate_faces, 1);
  EXPECT_EQ(c.nonfinite_vertices, 1);
}

TEST(Topology, EmptyMesh) {
  const mesh::MeshCheck c = mesh::check({});
  EXPECT_EQ(c.euler, 0);
  EXPECT_EQ(c.components, 0);
}

TEST(Topology, MatesPointAtEachOther) {
  const Mesh mesh = torus();
  const mesh::EdgeMap map = mesh::edge_map(mesh);
  for (int h = 0; h < int(map.mate.size()); ++h) {
    ASSERT_GE(map.mate[h], 0);
    ASSERT_EQ(map.mate[map.mate[h]], h);
    const auto from = [&](int i) { return mesh.faces[i / 3][i % 3]; };
    const auto to = [&](int i) { return mesh.faces[i / 3][(i % 3 + 1) % 3]; };
    ASSERT_EQ(from(h), to(map.mate[h]));
  }
}

}  // namespace
}  // namespace parts
