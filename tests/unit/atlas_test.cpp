// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "parts/base/error.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

double area(const Mesh& m, int f) {
  return (m.corner(f, 1) - m.corner(f, 0)).cross(m.corner(f, 2) - m.corner(f, 0)).norm() / 2;
}
double uv_area(const Wedges& w) {
  const Eigen::Vector2d a = (w.uv[1] - w.uv[0]).cast<double>(), b = (w.uv[2] - w.uv[0]).cast<double>();
  return (a.x() * b.y() - a.y() * b.x()) / 2;
}

/// Every face has its own place in the texture, the right way round, at about one scale.
void expect_unfolded(const Mesh& m, int size) {
  const render::Atlas atlas = render::make_atlas(m, size);
  ASSERT_EQ(atlas.wedges.size(), m.faces.size());
  const render::TexelMap map = render::map_texels(atlas.wedges, size);
  EXPECT_EQ(map.conflicts, 0);
  for (int f = 0; f < m.face_count(); ++f) {
    const Wedges& w = atlas.wedges[f];
    if (area(m, f) <= 0) continue;
    ASSERT_EQ(w.texture, 0);
    for (const auto& uv : w.uv) {
      EXPECT_GE(uv.minCoeff(), 0);
      EXPECT_LE(uv.maxCoeff(), 1);
    }
    const double scale = uv_area(w) * size * size / (area(m, f) * atlas.texels_per_unit * atlas.texels_per_unit);
    EXPECT_GT(scale, 0.15) << f;
    EXPECT_LT(scale, 1.1) << f;
  }
}

TEST(Atlas, UnfoldsWithoutOverlap) {
  expect_unfolded(sphere(), 256);
  expect_unfolded(torus(), 512);
  expect_unfolded(box({0, 0, 0}, {1, 2, 3}, 3), 256);
  expect_unfolded(animal(), 512);
  expect_unfolded(glasses(), 512);
}

TEST(Atlas, UnfoldsARolledSheetThatCoversItself) {
  Mesh roll;  // three turns of a spiral, every turn above the last
  const int n = 120;
  for (int i = 0; i <= n; ++i)
    for (double z : {0., 2.}) {
      const double angle = 6 * EIGEN_PI * i / n, radius = 1 + 0.02 * i;
      roll.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  for (int i = 0; i < n; ++i) {
    roll.faces.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    roll.faces.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
  }
  expect_unfolded(roll, 512);
}

TEST(Atlas, FewChartsOnARoughSurface) {
  EXPECT_LE(render::make_atlas(noisy_sphere(Vec3::Zero(), 1, 5, 0.05, 1), 1024).charts, 40);
}

TEST(Atlas, CornersOfTheirOwnAndDoubledFacesMakeNoCharts) {
  const Mesh whole = sphere();
  Mesh soup, doubled = whole;
  for (int f = 0; f < whole.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) soup.vertices.push_back(whole.corner(f, k));
    soup.faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  EXPECT_EQ(render::make_atlas(soup, 256).charts, render::make_atlas(whole, 256).charts);
  doubled.faces.insert(doubled.faces.end(), whole.faces.begin(), whole.faces.end());
  EXPECT_LE(render::make_atlas(doubled, 256).charts, 3 * render::make_atlas(whole, 256).charts);
  expect_unfolded(doubled, 256);
}

TEST(Atlas, FacesWithoutAreaHaveNoPlace) {
  Mesh m = sphere();
  m.faces.push_back({0, 0, 1});
  const render::Atlas atlas = render::make_atlas(m, 128);
  EXPECT_EQ(atlas.wedges.back().texture, -1);
  EXPECT_EQ(atlas.wedges.front().texture, 0);
}

TEST(Atlas, SaysWhenThereIsNoRoom) {
  Mesh soup;
  for (int i = 0; i < 400; ++i) {
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)})
      soup.vertices.push_back(p + Vec3(2. * (i % 20), 2. * (i / 20), 0));
    soup.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_THROW(render::make_atlas(soup, 64), UserError);
  EXPECT_EQ(render::make_atlas(soup, 512).charts, 400);
}

TEST(Atlas, TexelsKnowTheirPoints) {
  const Mesh m = sphere();
  const render::Atlas atlas = render::make_atlas(m, 256);
  const render::TexelMap map = render::map_texels(atlas.wedges, 256);
  long covered = 0;
  for (std::size_t at = 0; at < map.face.size(); ++at) {
    if (map.face[at] < 0) continue;
    ++covered;
    EXPECT_NEAR(map.barycentric[at].sum(), 1, 1e-5);
    EXPECT_GE(map.barycentric[at].minCoeff(), -1e-5);
    const Wedges& w = atlas.wedges[map.face[at]];
    const Eigen::Vector2f uv =
        map.barycentric[at][0] * w.uv[0] + map.barycentric[at][1] * w.uv[1] + map.barycentric[at][2] * w.uv[2];
    const Eigen::Vector2f center((float(at % 256) + 0.5f) / 256, 1 - (float(at / 256) + 0.5f) / 256);
    EXPECT_LT((uv - center).norm() * 256, 1.01);
  }
  EXPECT_GT(covered, 256 * 256 / 4);
}

TEST(TextureCoordinates, AreUsedOnlyWhereTheyHoldAPicture) {
  Mesh m = sphere();
  EXPECT_EQ(render::texture_coordinates_flaw(m, 256), "none");
  const render::Atlas atlas = render::make_atlas(m, 256);
  m.wedges = atlas.wedges;
  EXPECT_EQ(render::texture_coordinates_flaw(m, 256), "");
  m.wedges[3].texture = 1;
  EXPECT_EQ(render::texture_coordinates_flaw(m, 256), "several textures");
  m.wedges[3].texture = -1;
  EXPECT_EQ(render::texture_coordinates_flaw(m, 256), "not on all faces");
  m.wedges = atlas.wedges;
  m.wedges[3].uv[0].x() = 1.5;
  EXPECT_EQ(render::texture_coordinates_flaw(m, 256), "beyond the texture");
  m.wedges = atlas.wedges;
  for (std::size_t f = 0; f < m.wedges.size() / 2; ++f) m.wedges[f] = m.wedges[f + m.wedges.size() / 2];
  EXPECT_EQ(render::texture_coordinates_flaw(m, 256), "overlapping");
  for (Wedges& w : m.wedges) w.uv.fill({0.5f, 0.5f});
  EXPECT_EQ(render::texture_coordinates_flaw(m, 256), "degenerate");
}

}  // namespace
}  // namespace parts::test
