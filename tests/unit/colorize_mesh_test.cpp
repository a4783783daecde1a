// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/colorize/colorize_mesh.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "parts/base/error.h"
#include "parts/colorize/find_frame.h"
#include "parts/colorize/hidden_colors.h"
#include "parts/colorize/posed_mesh.h"
#include "parts/io/mesh_io.h"
#include "parts/render/atlas.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

namespace fs = std::filesystem;

/// Red above, green below, blue in front: by direction from the middle.
Color paint(const Vec3& p, double shade) {
  const Vec3 n = p.normalized();
  const auto tone = [&](double t) { return std::uint8_t(std::clamp(255 * shade * t, 0., 255.)); };
  return {tone(0.5 + 0.5 * n.y()), tone(0.5 - 0.5 * n.y()), tone(0.5 + 0.5 * n.z()), 255};
}

/// An egg with a nose, so that its pose shows.
Mesh egg(double nose) {
  Mesh m = sphere(Vec3::Zero(), 1, 4);
  for (Vec3& v : m.vertices) {
    const double bump = std::exp(-8 * (v - Vec3(0, 0.2, 1)).squaredNorm());
    v = Vec3(0.8 * v.x(), 1.1 * v.y(), v.z() + nose * bump);
  }
  return m;
}
Mesh painted(Mesh m, double shade = 1) {
  for (const Vec3& v : m.vertices) m.vertex_color.push_back(paint(v, shade));
  return m;
}

class ColorizeMeshTest : public test::Folder {
 protected:
  void SetUp() override {
    options_.views = render::parse_views("0,0; 90,0; 180,0; -90,0; 0,80; 0,-80");
    options_.rendering.width = 60, options_.rendering.height = 80;
    options_.rendering.light.ambient = 1, options_.rendering.back = false;
    options_.patch_sizes = {5, 7};
  }
  void model(const char* name, const Mesh& mesh) const { io::write_mesh(mesh, (folder / name).string()); }
  colorize::MeshColors colored(const Mesh& mesh) {
    Progress silent;
    examples::ClassModels models(io::ModelDatabase(folder.string(), silent), options_.views, options_.rendering,
                                 silent);
    return colorize::colorize_mesh(mesh, models, options_, silent);
  }
  static double mean_error(const Mesh& mesh, const std::vector<Color>& colors) {
    double sum = 0;
    for (int v = 0; v < mesh.vertex_count(); ++v)
      for (int k = 0; k < 3; ++k) sum += std::abs(colors[v][k] - paint(mesh.vertices[v], 1)[k]);
    return sum / (3.0 * mesh.vertex_count());
  }

  colorize::ColorizeMeshOptions options_;
};

TEST_F(ColorizeMeshTest, ColorsComeToTheirPlacesAllAround) {
  model("a.ply", painted(egg(0.3)));
  model("b.ply", painted(egg(0.5)));
  const Mesh query = egg(0.4);
  const colorize::MeshColors colors = colored(query);
  EXPECT_LT(mean_error(query, colorize::vertex_colors(colors)), 8);
  EXPECT_GT(colors.seen, 0.95);
  EXPECT_EQ(colors.used.size(), 2u);
  for (const auto& level : colors.objective)
    for (std::size_t i = 1; i < level.size(); ++i) EXPECT_GE(level[i], level[i - 1] - 1e-6);
}

TEST_F(ColorizeMeshTest, ProgressNeverRunsBackwards) {
  model("a.ply", painted(egg(0.3)));
  Progress silent;
  examples::ClassModels models(io::ModelDatabase(folder.string(), silent), options_.views, options_.rendering, silent);
  std::vector<int> percents;
  Progress progress([&](int percent, const char*) { return percents.push_back(percent), true; });
  colorize::colorize_mesh(egg(0.4), models, options_, progress);
  EXPECT_TRUE(std::is_sorted(percents.begin(), percents.end()));
}

TEST(HiddenColors, WhatCannotBeContinuedIsSaid) {
  examples::ClassModel model;
  model.mesh = sphere(Vec3::Zero(), 1, 3);
  model.mesh.vertex_color.assign(model.mesh.vertices.size(), {200, 200, 200, 255});
  const Mesh query = sphere(Vec3::Zero(), 1, 3);
  std::vector<char> known;
  for (const Vec3& v : query.vertices) known.push_back(v.z() > 0);
  const Eigen::Vector3f darker(100 / 255.f, 128 / 255.f, 128 / 255.f);
  std::vector<Eigen::Vector3f> color(known.size(), darker);
  EXPECT_TRUE(colorize::complete_colors(query, known, model, color, 1));
  for (const Eigen::Vector3f& c : color) EXPECT_NEAR(c[0], darker[0], 0.03);

  color.assign(known.size(), darker);
  for (std::size_t v = 0; v < known.size(); ++v)
    if (known[v]) color[v].setConstant(std::nanf(""));
  EXPECT_FALSE(colorize::complete_colors(query, known, model, color, 1));
  for (std::size_t v = 0; v < known.size(); ++v) {
    if (known[v]) continue;
    EXPECT_NEAR(color[v][0], 200 / 255.f, 1e-3) << "the model's own";
  }
}

TEST_F(ColorizeMeshTest, AnotherUnitPlaceAndStance) {
  model("a.ply", painted(egg(0.3)));
  Mesh query = egg(0.4);
  for (Vec3& v : query.vertices) v = 1000 * Vec3(v.x(), -v.z(), v.y()) + Vec3(5, 7, 9);  // lying on its back
  options_.up = {0, 0, 1}, options_.front = {0, -1, 0};
  EXPECT_LT(mean_error(egg(0.4), colorize::vertex_colors(colored(query))), 8);
}

TEST_F(ColorizeMeshTest, FindsTheAxesThatTheMeshStandsAlong) {
  for (unsigned seed = 1; seed < 6; ++seed)
    model(("bust" + std::to_string(seed) + ".ply").c_str(), painted(bust(seed, 30)));
  Progress silent;
  examples::ClassModels models(io::ModelDatabase(folder.string(), silent), options_.views, options_.rendering, silent);
  const Mesh query = bust(9, 30);
  const auto found = [&](const Eigen::Matrix3d& turn) {
    const Mesh turned = moved(query, Eigen::Affine3d(turn));
    return colorize::find_frame(colorize::pose(turned, models, options_).mesh, models, options_);
  };
  EXPECT_FALSE(found(Eigen::Matrix3d::Identity())) << "it stands as it should";
  for (int up = 0; up < 6; ++up)
    for (int front = 0; front < 6; ++front) {
      if (up / 2 == front / 2 || (up == 2 && front == 4)) continue;
      const Vec3 y = Vec3::Unit(up / 2) * (up % 2 ? -1 : 1), z = Vec3::Unit(front / 2) * (front % 2 ? -1 : 1);
      Eigen::Matrix3d turn;
      turn << y.cross(z), y, z;
      const auto s = found(turn);
      EXPECT_TRUE(s && s->up == y && s->front == z) << "up " << y.transpose() << ", front " << z.transpose();
    }
  options_.find_frame = true;
  Mesh lying = query;
  for (Vec3& v : lying.vertices) v = Vec3(v.x(), -v.z(), v.y());
  const colorize::MeshColors colors = colored(lying);
  ASSERT_TRUE(colors.turned);
  EXPECT_EQ(colors.turned->up, Vec3(0, 0, 1));
  EXPECT_LT(mean_error(query, colorize::vertex_colors(colors)), 12);
  EXPECT_TRUE(colors.trusted());
  options_.find_frame = false;
  EXPECT_GT(colored(lying).patch_distance, 1.3 * colors.patch_distance);
}

TEST_F(ColorizeMeshTest, HiddenPartsFollowTheModel) {
  model("a.ply", painted(together({egg(0.3), moved(egg(0), Eigen::Affine3d(Eigen::Scaling(0.5)))})));
  const Mesh inner = moved(egg(0), Eigen::Affine3d(Eigen::Scaling(0.55)));
  const Mesh query = together({egg(0.4), inner});
  const colorize::MeshColors colors = colored(query);
  EXPECT_LT(colors.seen, 0.85);
  EXPECT_LT(mean_error(query, colorize::vertex_colors(colors)), 8);
}

TEST_F(ColorizeMeshTest, KeptColorsStayAndTheOthersGoWithThem) {
  model("dark.ply", painted(egg(0.3), 0.5));
  Mesh query = egg(0.4);
  for (const Vec3& v : query.vertices) {
    Color c = paint(v, 0.5);
    for (int k = 0; k < 3; ++k) c[k] = std::uint8_t(c[k] + 60);  // brighter all over
    query.vertex_color.push_back(c);
  }
  options_.keep = faces_where(query, [](const Vec3& center) { return center.z() > 0; });
  const std::vector<Color> truth = query.vertex_color;
  const colorize::MeshColors colors = colored(query);
  const std::vector<Color> found = colorize::vertex_colors(colors);
  double front = 0, back = 0;
  int fronts = 0, backs = 0;
  for (int v = 0; v < query.vertex_count(); ++v) {
    double error = 0;
    for (int k = 0; k < 3; ++k) error += std::abs(found[v][k] - truth[v][k]) / 3.;
    (query.vertices[v].z() > 0.1 ? front : back) += error;
    ++(query.vertices[v].z() > 0.1 ? fronts : backs);
  }
  EXPECT_LT(front / fronts, 1);
  EXPECT_LT(back / backs, 12);
}

TEST_F(ColorizeMeshTest, TheTextureShowsTheSameAsTheVertices) {
  model("a.ply", painted(egg(0.3)));
  const Mesh query = egg(0.4);
  const colorize::MeshColors colors = colored(query);
  const render::Atlas atlas = render::make_atlas(query, 256);
  const colorize::BakedTexture baked = colorize::bake_texture(query, atlas.wedges, 256, colors, 0);
  const std::vector<Color> vertices = colorize::vertex_colors(colors);
  double sum = 0;
  for (int f = 0; f < query.face_count(); ++f) {
    const Eigen::Vector2f uv = (atlas.wedges[f].uv[0] + atlas.wedges[f].uv[1] + atlas.wedges[f].uv[2]) / 3;
    const cv::Point at(int(uv.x() * 256), int((1 - uv.y()) * 256));
    ASSERT_TRUE(baked.mask.at<uchar>(at));
    for (int k = 0; k < 3; ++k) {
      double mean = 0;
      for (int v : query.faces[f]) mean += vertices[v][k] / 3.;
      sum += std::abs(baked.color.at<cv::Vec3b>(at)[2 - k] - mean);
    }
  }
  EXPECT_LT(sum / (3.0 * query.face_count()), 4);
}

TEST_F(ColorizeMeshTest, InsideOutAndAnyNumberOfThreads) {
  model("a.ply", painted(egg(0.3)));
  Mesh query = egg(0.4);
  options_.threads = 1;
  const std::vector<Color> one = colorize::vertex_colors(colored(query));
  options_.threads = 5;
  EXPECT_EQ(one, colorize::vertex_colors(colored(query)));
  for (Triangle& f : query.faces) std::swap(f[1], f[2]);
  const colorize::MeshColors turned = colored(query);
  EXPECT_FALSE(turned.oriented);
  EXPECT_LT(mean_error(query, colorize::vertex_colors(turned)), 8);
}

TEST_F(ColorizeMeshTest, LevelsWithoutSearchAddDetail) {
  model("a.ply", painted(egg(0.3)));
  options_.rendering.width = 240, options_.rendering.height = 320;  // searched at half of it
  const Mesh query = egg(0.4);
  EXPECT_LT(mean_error(query, colorize::vertex_colors(colored(query))), 8);
}

TEST_F(ColorizeMeshTest, WhatCannotBeColored) {
  model("grey.ply", egg(0.3));
  EXPECT_THROW(colored(egg(0.4)), UserError);  // no model has colours
  model("a.ply", painted(egg(0.3)));
  EXPECT_NO_THROW(colored(egg(0.4)));
  EXPECT_THROW(colored(Mesh{}), UserError);
  Mesh point;
  point.vertices.assign(3, Vec3(1, 2, 3));
  point.faces = {{0, 1, 2}};
  EXPECT_THROW(colored(point), UserError);
  options_.choose = {"nobody"};
  EXPECT_THROW(colored(egg(0.4)), UserError);
  options_.choose = {"grey"};
  EXPECT_THROW(colored(egg(0.4)), UserError);
}

TEST(ViewSheet, PixelsOfOnePointAgree) {
  const Mesh m = sphere(Vec3::Zero(), 1, 4);
  examples::ClassModel model{"m", m, {}, Vec3::Zero(), 2.4};
  examples::ExampleOptions rendering;
  rendering.width = rendering.height = 64, rendering.back = false;
  std::vector<examples::Example> views;
  for (double yaw : {0., 40.}) views.push_back(examples::render_example(model, {yaw, 0}, 60, rendering));
  const colorize::ViewSheet sheet(views, {{0, 0, 64, 64}, {0, 0, 64, 64}}, 2, 2, 1);
  cv::Mat plane(sheet.size(), CV_32F, cv::Scalar(0));
  plane(cv::Rect(sheet.tiles()[1].place, cv::Size(64, 64))).setTo(1);
  std::vector<cv::Mat> planes{plane};
  sheet.agree(0, planes);
  const Vec3 between(std::sin(20 * EIGEN_PI / 180), 0, std::cos(20 * EIGEN_PI / 180));
  float value = -1;
  EXPECT_GT(sheet.look({plane}, 0, between, between, &value), 1);  // both see it, neither quite from the front
  EXPECT_NEAR(value, 0.5, 0.05);
  for (const auto& tile : sheet.tiles()) {
    const Vec3 at = tile.camera.project(between);
    EXPECT_NEAR(planes[0].at<float>(int(at.y()) + tile.place.y, int(at.x()) + tile.place.x), 0.5, 0.06);
  }
  value = -1;
  EXPECT_EQ(sheet.look({plane}, 0, Vec3(0, 0, -1), Vec3(0, 0, -1), &value), 0);
  EXPECT_EQ(value, -1);
}

}  // namespace
}  // namespace parts::test
