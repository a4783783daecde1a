// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/patch_color.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "mend_support.h"

namespace parts::test {
namespace {

constexpr Color kSkin{150, 110, 90, 255};  // of the model's texture

/// A texture of one colour, and a bust that wears it.
struct TexturedModel {
  std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("patch_color_" + std::to_string(::getpid()) + ".png");
  std::vector<mend::PlacedModel> models = similar_bust();
  TexturedModel() {
    cv::imwrite(file.string(), cv::Mat(8, 8, CV_8UC3, cv::Scalar(kSkin[2], kSkin[1], kSkin[0])));
    models[0].mesh.textures = {file.string()};
  }
  ~TexturedModel() { std::filesystem::remove(file); }
};

/// The nose's scan with vertex colours in place of its texture.
Mesh painted(const NoseHole& n, const std::function<Color(const Vec3&)>& color) {
  Mesh scan = n.scan;
  scan.wedges.clear(), scan.textures.clear();
  for (const Vec3& v : scan.vertices) scan.vertex_color.push_back(color(v));
  return scan;
}

/// Vertices that no face of the scan has.
std::vector<int> of_the_patch(const mend::Restored& r) {
  std::vector<char> own(r.mesh.vertices.size(), 1);
  for (int f = 0; f < r.mesh.face_count(); ++f)
    if (r.source[f] >= 0)
      for (int v : r.mesh.faces[f]) own[v] = 0;
  std::vector<int> list;
  for (std::size_t v = 0; v < own.size(); ++v)
    if (own[v]) list.push_back(int(v));
  return list;
}

void expect_near(const Color& a, const Color& b, int by) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], by);
}

TEST(PatchColor, ATexturedModelGivesVertexColoursToAScanThatHasSuch) {
  const NoseHole n;
  const TexturedModel model;
  constexpr Color kDark{60, 40, 30, 255};
  const Mesh scan = painted(n, [&](const Vec3&) { return kDark; });
  mend::RestoreOptions options;
  options.match_color = false;
  const mend::Restored own = fill_quietly(scan, model.models, options), matched = fill_quietly(scan, model.models);
  ASSERT_EQ(own.mesh.vertex_color.size(), own.mesh.vertices.size());
  EXPECT_TRUE(own.mesh.textures.empty());
  EXPECT_TRUE(own.mesh.wedges.empty());
  ASSERT_GT(of_the_patch(own).size(), 50u);
  for (int v : of_the_patch(own)) expect_near(own.mesh.vertex_color[v], kSkin, 1);
  for (int v : of_the_patch(matched)) expect_near(matched.mesh.vertex_color[v], kDark, 1);
}

TEST(PatchColor, AScanWithoutColoursGetsNone) {
  const NoseHole n;
  const TexturedModel model;
  std::vector<mend::PlacedModel> painted_model = similar_bust();
  Mesh& m = painted_model[0].mesh;
  m.wedges.clear(), m.textures.clear();
  m.vertex_color.assign(m.vertices.size(), kSkin);
  for (const auto& models : {model.models, painted_model}) {
    Mesh scan = n.scan;
    scan.wedges.clear(), scan.textures.clear(), scan.vertex_color.clear(), scan.face_color.clear();
    const Mesh mesh = fill_quietly(scan, models).mesh;
    EXPECT_GT(mesh.face_count(), scan.face_count());
    EXPECT_TRUE(mesh.vertex_color.empty());
    EXPECT_TRUE(mesh.face_color.empty());
    EXPECT_TRUE(mesh.textures.empty());
  }
}

TEST(PatchColor, WhatDiffersAtTheRimFadesOverThePatch) {
  const NoseHole n;
  const TexturedModel model;
  // Lit from the left.
  const auto lit = [&](const Vec3& p) {
    const auto level = std::uint8_t(120 + 60 * std::clamp((n.tip.x() - p.x()) / 0.16, -1.0, 1.0));
    return Color{level, level, level, 255};
  };
  const mend::Restored r = fill_quietly(painted(n, lit), model.models);
  double left = 0, right = 0;
  int lefts = 0, rights = 0;
  for (int v : of_the_patch(r)) {
    const Vec3 d = r.mesh.vertices[v] - n.tip;
    if (std::abs(d.x()) < 0.06) continue;
    (d.x() < 0 ? left : right) += r.mesh.vertex_color[v][1];
    ++(d.x() < 0 ? lefts : rights);
  }
  ASSERT_GT(lefts, 5);
  ASSERT_GT(rights, 5);
  EXPECT_GT(left / lefts, right / rights + 20);
  EXPECT_NEAR(left / lefts + right / rights, 240, 40);
}

TEST(PatchColor, ATexturedScanKeepsItsLookBesideAPatchWithVertexColours) {
  NoseHole n;
  const TexturedModel model;
  n.scan.textures = model.models[0].mesh.textures;
  std::vector<mend::PlacedModel> plain = model.models;
  Mesh& m = plain[0].mesh;
  m.wedges.clear(), m.textures.clear();
  m.vertex_color.assign(m.vertices.size(), Color{90, 90, 200, 255});
  const mend::Restored r = fill_quietly(n.scan, plain);
  ASSERT_EQ(r.mesh.vertex_color.size(), r.mesh.vertices.size());
  for (const Color& c : r.mesh.vertex_color) expect_near(c, kSkin, 2);  // nothing is white or blue
  for (int f = 0; f < r.mesh.face_count(); ++f)
    if (r.source[f] >= 0) {
      EXPECT_EQ(r.mesh.wedges[f].texture, 0);
    }
}

}  // namespace
}  // namespace parts::test
