// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/prepare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "parts/mesh/topology.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

/// Every face with vertices of its own, as an .stl file gives them.
Mesh soup(const Mesh& mesh) {
  Mesh out;
  for (int f = 0; f < mesh.face_count(); ++f) {
    out.faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    for (int k = 0; k < 3; ++k) out.vertices.push_back(mesh.corner(f, k));
  }
  return out;
}

double signed_volume(const Mesh& mesh) {
  double sum = 0;
  for (int f = 0; f < mesh.face_count(); ++f) sum += mesh.corner(f, 0).dot(mesh.corner(f, 1).cross(mesh.corner(f, 2)));
  return sum / 6;
}

TEST(Prepare, LeavesACleanMeshAsItIs) {
  const Mesh mesh = torus();
  const mesh::Prepared p = mesh::prepare(mesh);
  EXPECT_EQ(p.mesh.vertices, mesh.vertices);
  EXPECT_EQ(p.mesh.faces, mesh.faces);
  EXPECT_EQ(p.components, 1);
  EXPECT_TRUE(p.closed[0]);
  EXPECT_EQ(p.welded_vertices + p.dropped_faces + p.reversed_faces, 0);
}

TEST(Prepare, WeldsASoupIntoAClosedSurface) {
  const Mesh mesh = sphere({1, 2, 3}, 2, 2);
  const mesh::Prepared p = mesh::prepare(soup(mesh));
  EXPECT_EQ(p.mesh.vertex_count(), mesh.vertex_count());
  EXPECT_EQ(p.welded_vertices, 3 * mesh.face_count() - mesh.vertex_count());
  const mesh::MeshCheck c = mesh::check(p.mesh);
  EXPECT_TRUE(c.closed() && c.manifold() && c.oriented()) << mesh::to_string(c);
  EXPECT_EQ(p.components, 1);
}

TEST(Prepare, DropsWhatIsNoTriangleAndKeepsZeroArea) {
  Mesh mesh = box(Vec3::Zero(), Vec3::Ones());
  const int faces = mesh.face_count(), v = mesh.vertex_count();
  mesh.vertices.emplace_back(std::nan(""), 0, 0);
  mesh.vertices.emplace_back(0, std::numeric_limits<double>::infinity(), 0);
  mesh.vertices.push_back(mesh.vertices[0]);                             // as vertex 0
  mesh.vertices.push_back(0.5 * (mesh.vertices[0] + mesh.vertices[1]));  // collinear with 0 and 1
  mesh.faces.push_back({0, 1, v});
  mesh.faces.push_back({v + 1, 1, 2});
  mesh.faces.push_back({0, 0, 1});
  mesh.faces.push_back({v + 2, 1, 0});  // repeats vertex 0 once it is welded
  mesh.faces.push_back({mesh.faces[0][1], mesh.faces[0][2], mesh.faces[0][0]});
  mesh.faces.push_back({mesh.faces[1][1], mesh.faces[1][0], mesh.faces[1][2]});  // turned over: still the same face
  mesh.faces.push_back({0, 1, v + 3});
  const mesh::Prepared p = mesh::prepare(mesh);
  EXPECT_EQ(p.dropped_faces, 6);
  EXPECT_EQ(p.mesh.face_count(), faces + 1);
  EXPECT_EQ(p.source_face.back(), mesh.face_count() - 1);
  EXPECT_EQ(p.welded_vertices, 1);
  for (const Vec3& q : p.mesh.vertices) EXPECT_TRUE(q.allFinite());
}

TEST(Prepare, NothingUsableGivesNoFaces) {
  EXPECT_EQ(mesh::prepare(Mesh()).mesh.face_count(), 0);
  Mesh points;
  points.vertices = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(mesh::prepare(points).components, 0);
  points.faces = {{0, 1, 1}};
  EXPECT_EQ(mesh::prepare(points).mesh.face_count(), 0);
}

TEST(Prepare, TurnsTheSmallerShareOver) {
  const Mesh mesh = sphere();
  Random random(7);
  Mesh mixed = mesh;
  int turned = 0;
  for (Triangle& f : mixed.faces)
    if (random.uniform(0, 1) < 0.3) std::swap(f[0], f[1]), ++turned;
  const mesh::Prepared p = mesh::prepare(mixed);
  EXPECT_EQ(p.reversed_faces, turned);
  EXPECT_TRUE(mesh::check(p.mesh).oriented());
  EXPECT_NEAR(signed_volume(p.mesh), signed_volume(mesh), 1e-9);
}

TEST(Prepare, TextureCornersFollowATurnedFace) {
  Mesh mesh = sphere();
  mesh.textures = {"a.png"};
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (f % 5 == 0) std::swap(mesh.faces[f][0], mesh.faces[f][2]);
    mesh.wedges.emplace_back();
    mesh.wedges.back().texture = 0;
    for (int k = 0; k < 3; ++k) mesh.wedges.back().uv[k] = mesh.corner(f, k).head<2>().cast<float>();
  }
  const mesh::Prepared p = mesh::prepare(mesh);
  EXPECT_GT(p.reversed_faces, 0);
  for (int f = 0; f < p.mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(p.mesh.wedges[f].uv[k], (p.mesh.corner(f, k).head<2>().cast<float>()));
}

TEST(Prepare, NumbersComponentsAndSaysWhichAreClosed) {
  Mesh open = sphere({5, 0, 0});
  open.faces.pop_back();
  const mesh::Prepared p = mesh::prepare(together({sphere(), open, box({9, 0, 0}, {10, 1, 1})}));
  ASSERT_EQ(p.components, 3);
  EXPECT_TRUE(p.closed[0]);
  EXPECT_FALSE(p.closed[1]);
  EXPECT_TRUE(p.closed[2]);
  EXPECT_TRUE(std::is_sorted(p.component.begin(), p.component.end()));
}

TEST(Prepare, ThreeFacesAtAnEdgeAreOneComponent) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const mesh::Prepared p = mesh::prepare(mesh);
  EXPECT_EQ(p.components, 1);
  EXPECT_FALSE(p.closed[0]);
  EXPECT_EQ(p.mesh.face_count(), 3);
}

TEST(Prepare, AMoebiusStripComesBackWhole) {
  Mesh strip;
  constexpr int kRings = 20;
  for (int i = 0; i < kRings; ++i)
    for (const double side : {-0.3, 0.3}) {
      const double u = 2 * M_PI * i / kRings, r = 1 + side * std::cos(u / 2);
      strip.vertices.emplace_back(r * std::cos(u), r * std::sin(u), side * std::sin(u / 2));
    }
  for (int i = 0; i < kRings; ++i) {
    const bool last = i + 1 == kRings;
    const int a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    strip.faces.push_back({a, b, c});
    strip.faces.push_back({c, b, d});
  }
  const mesh::Prepared p = mesh::prepare(strip);
  EXPECT_EQ(p.mesh.face_count(), strip.face_count());
  EXPECT_EQ(p.components, 1);
}

}  // namespace
}  // namespace parts::test
