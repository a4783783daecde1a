// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/attributes.h"
#include "unit/compose_support.h"

namespace parts::test {
namespace {

constexpr Color kRed{200, 0, 0, 255}, kBlue{0, 0, 200, 255};

/// Attributes that can be recognised: quality is x, texture coordinates (x, y).
void dress(Mesh& mesh, const Color& color, const std::string& texture) {
  mesh.textures = {texture};
  mesh.vertex_color.assign(mesh.vertices.size(), color);
  mesh.face_color.assign(mesh.faces.size(), color);
  mesh.face_quality.assign(mesh.faces.size(), float(color[0]));
  for (const Vec3& v : mesh.vertices) mesh.vertex_quality.push_back(float(v.x()));
  mesh.wedges.resize(mesh.faces.size());
  for (int f = 0; f < mesh.face_count(); ++f) {
    mesh.wedges[f].texture = 0;
    for (int k = 0; k < 3; ++k) mesh.wedges[f].uv[k] = mesh.corner(f, k).head<2>().cast<float>();
  }
  mesh::update_normals(mesh);
}

TEST(ComposeAttributes, TravelWithTheirFaces) {
  auto [a, b] = two_spheres(4);
  dress(a.mesh, kRed, "a.png"), dress(b.mesh, kBlue, "b.png");
  const compose::ComposeResult r = compose_quietly(a, b);
  const Mesh& m = r.composed;
  ASSERT_EQ(m.vertex_color.size(), m.vertices.size());
  ASSERT_EQ(m.vertex_quality.size(), m.vertices.size());
  ASSERT_EQ(m.vertex_normal.size(), m.vertices.size());
  ASSERT_EQ(m.face_color.size(), m.faces.size());
  ASSERT_EQ(m.face_quality.size(), m.faces.size());
  ASSERT_EQ(m.wedges.size(), m.faces.size());
  EXPECT_EQ(m.textures, (std::vector<std::string>{"a.png", "b.png"}));
  int bad_quality = 0, bad_uv = 0, bad_color = 0, bad_normal = 0, of[2] = {0, 0};
  const double near = 2 * r.report.seam_edge;
  for (int f = 0; f < m.face_count(); ++f) {
    const bool seam =
        m.face_box(f).exteriorDistance(Vec3(0.5, m.face_box(f).center().y(), m.face_box(f).center().z())) < 2 * near;
    const int from = r.face_from_b[f];
    ASSERT_TRUE(m.wedges[f].texture == 0 || m.wedges[f].texture == 1);
    if (from < 2) {
      ++of[from];
      EXPECT_EQ(m.face_color[f], from ? kBlue : kRed);
      EXPECT_EQ(m.face_quality[f], from ? 0.f : 200.f);
      EXPECT_EQ(m.wedges[f].texture, from);
    }
    for (int k = 0; k < 3; ++k) {
      const Vec3& p = m.corner(f, k);
      const int v = m.faces[f][k];
      // Vertices that the seam moved keep what they had.
      const double tolerance = seam ? 2 * near : 1e-5;
      bad_quality += std::abs(m.vertex_quality[v] - p.x()) > tolerance;
      bad_uv += from < 2 && (m.wedges[f].uv[k].cast<double>() - p.head<2>()).norm() > tolerance;
      bad_color += from < 2 && !seam && m.vertex_color[v] != (from ? kBlue : kRed);
      const Vec3 radial = (p - Vec3(p.x() < 0.5 ? 0 : 1, 0, 0)).normalized();
      bad_normal += m.vertex_normal[v].cast<double>().dot(radial) < (seam ? 0.5 : 0.99);
    }
  }
  EXPECT_EQ(bad_quality, 0);
  EXPECT_EQ(bad_uv, 0);
  EXPECT_EQ(bad_color, 0);
  EXPECT_EQ(bad_normal, 0);
  EXPECT_GT(of[0], 100);
  EXPECT_GT(of[1], 100);
}

TEST(ComposeAttributes, WhatOneModelLacksIsNeutral) {
  for (const bool a_has : {true, false}) {
    auto [a, b] = two_spheres();
    dress(a_has ? a.mesh : b.mesh, kRed, "only.png");
    const compose::ComposeResult r = compose_quietly(a, b);
    const Mesh& m = r.composed;
    ASSERT_EQ(m.wedges.size(), m.faces.size());
    ASSERT_EQ(m.face_color.size(), m.faces.size());
    ASSERT_EQ(m.vertex_quality.size(), m.vertices.size());
    EXPECT_EQ(m.textures, std::vector<std::string>{"only.png"});
    for (int f = 0; f < m.face_count(); ++f) {
      if (r.face_from_b[f] == 2) continue;
      const bool dressed = (r.face_from_b[f] == 0) == a_has;
      EXPECT_EQ(m.wedges[f].texture, dressed ? 0 : -1);
      EXPECT_EQ(m.face_color[f], dressed ? kRed : (Color{255, 255, 255, 255}));
    }
  }
}

TEST(ComposeAttributes, NoneComesOutOfNothing) {
  const auto [a, b] = two_spheres();
  const Mesh m = compose_quietly(a, b).composed;
  EXPECT_TRUE(m.vertex_color.empty() && m.vertex_quality.empty() && m.vertex_normal.empty() && m.face_color.empty() &&
              m.face_quality.empty() && m.wedges.empty() && m.textures.empty());
}

TEST(ComposeAttributes, TheSameTextureFileIsListedOnce) {
  auto [a, b] = two_spheres();
  dress(a.mesh, kRed, "one.png"), dress(b.mesh, kBlue, "one.png");
  const Mesh m = compose_quietly(a, b).composed;
  EXPECT_EQ(m.textures, std::vector<std::string>{"one.png"});
  for (const Wedges& w : m.wedges) EXPECT_EQ(w.texture, 0);
}

TEST(ComposeAttributes, NormalsFollowAModelThatIsTurnedOver) {
  auto [a, b] = two_spheres(4);
  mesh::update_normals(a.mesh);
  mesh::update_normals(b.mesh);
  mesh::flip_orientation(b.mesh);
  const compose::ComposeResult r = compose_quietly(a, b);
  EXPECT_TRUE(r.report.reversed_b);
  Mesh fresh = r.composed;
  mesh::update_normals(fresh);
  for (int v = 0; v < fresh.vertex_count(); ++v)
    EXPECT_GT(fresh.vertex_normal[v].dot(r.composed.vertex_normal[v]), 0.5f);
}

}  // namespace
}  // namespace parts::test
