// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/rasterize.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "parts/render/surface_color.h"
#include "support/cameras.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace parts {
namespace {

using namespace parts::test;

render::Camera facing(const Mesh& mesh, int width, int height, double yaw = 0) {
  return render::orthographic_camera(render::view_rotation({yaw, 0}, {0, 1, 0}, {0, 0, 1}), mesh.bounds(), width,
                                     height);
}

bool same(const cv::Mat& a, const cv::Mat& b) {  // bit for bit, NaN too
  return a.size() == b.size() && a.type() == b.type() && std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

TEST(Rasterize, DepthsOfASphere) {
  const Mesh mesh = sphere({3, -2, 5}, 2, 5);
  for (const bool pinhole : {false, true}) {
    render::Camera camera = facing(mesh, 150, 200, 30);
    if (pinhole) camera = pinhole_camera(camera.rotation, mesh.bounds(), 150, 200, 250);
    const render::Rendering r = render::render(mesh, {}, camera, {});
    int covered = 0;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 150; ++x) {
        ASSERT_EQ(r.mask.at<uchar>(y, x) > 0, r.face.at<int>(y, x) >= 0);
        ASSERT_EQ(r.mask.at<uchar>(y, x) == 0, std::isnan(r.depth.at<float>(y, x)));
        if (!r.mask.at<uchar>(y, x)) continue;
        ++covered;
        const double front = r.depth.at<float>(y, x), back = r.back_depth.at<float>(y, x);
        ASSERT_LE(front, back);
        for (double z : {front, back})
          ASSERT_NEAR((camera.unproject(x + 0.5, y + 0.5, z) - Vec3(3, -2, 5)).norm(), 2, 0.01);
      }
    EXPECT_GT(covered, 4000);
    EXPECT_FALSE(std::isnan(r.depth.at<float>(100, 75)));
    EXPECT_NEAR(r.back_depth.at<float>(100, 75) - r.depth.at<float>(100, 75), 4, 0.01);
  }
}

TEST(Rasterize, CoverageHasNoGapsAndNoOverlaps) {
  // A plane of random triangles that fills the image: each pixel exactly once.
  Random random(3);
  Mesh mesh;
  constexpr int n = 40;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      const bool inner = x > 0 && y > 0 && x < n && y < n;
      // Many vertices lie exactly on pixel centres and on pixel rows.
      const double shift = inner ? 0.25 * random.below(3) : 0;
      mesh.vertices.emplace_back(x + shift, y - shift, inner ? random.uniform(0, 1) : 0);
    }
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x, b = a + 1, c = a + n + 2, d = a + n + 1;
      mesh.faces.push_back({a, b, c});
      mesh.faces.push_back({a, c, d});
    }
  render::Camera camera;
  camera.width = camera.height = 80;
  camera.scale = 2;
  camera.center = {0, 80};
  camera.eye = {0, 0, 10};
  const render::Rendering r = render::render(mesh, {}, camera, {});
  EXPECT_EQ(cv::countNonZero(r.mask), 80 * 80);
  // Each pixel once: no second layer anywhere.
  EXPECT_TRUE(same(r.depth, r.back_depth));
}

TEST(Rasterize, SameForAnyThreads) {
  Mesh mesh = noisy_sphere({0, 0, 0}, 1, 5, 0.5, 3);
  for (const Vec3& p : mesh.vertices)
    mesh.vertex_color.push_back({std::uint8_t(128 + 100 * p.x()), 90, std::uint8_t(128 + 100 * p.y()), 255});
  render::RenderOptions options;
  options.threads = 1;
  const render::Camera camera = facing(mesh, 151, 203);
  const render::Rendering one = render::render(mesh, {}, camera, options);
  for (int threads : {2, 3, 8, 500}) {
    options.threads = threads;
    const render::Rendering many = render::render(mesh, {}, camera, options);
    EXPECT_TRUE(same(one.image, many.image) && same(one.depth, many.depth) && same(one.face, many.face));
    EXPECT_TRUE(same(one.back_depth, many.back_depth));
  }
}

Mesh square() {
  Mesh mesh;
  mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

render::RenderOptions unlit() {
  render::RenderOptions options;
  options.light.ambient = 1;
  return options;
}

using RasterizeFiles = test::Folder;
TEST_F(RasterizeFiles, TextureStandsUpright) {
  Mesh mesh = square();
  const std::string file = at("texture.png");
  cv::Mat image(64, 64, CV_8UC3, cv::Scalar(0, 0, 0));
  image(cv::Rect(0, 0, 32, 32)) = cv::Scalar(255, 0, 0);   // top left blue
  image(cv::Rect(32, 0, 32, 32)) = cv::Scalar(0, 255, 0);  // top right green
  image(cv::Rect(0, 32, 32, 32)) = cv::Scalar(0, 0, 255);  // bottom left red
  cv::imwrite(file, image);
  mesh.textures = {file};
  mesh.wedges = {{{Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(1, 1)}, 0},
                 {{Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 1), Eigen::Vector2f(0, 1)}, 0}};
  for (int size : {8, 64, 200}) {  // smaller, as large and larger than the texture
    const render::Rendering r = render::render(mesh, render::load_textures(mesh), facing(mesh, size, size), unlit());
    EXPECT_EQ(r.image.at<cv::Vec3b>(size / 4, size / 4), cv::Vec3b(255, 0, 0));
    EXPECT_EQ(r.image.at<cv::Vec3b>(size / 4, size * 3 / 4), cv::Vec3b(0, 255, 0));
    EXPECT_EQ(r.image.at<cv::Vec3b>(size * 3 / 4, size / 4), cv::Vec3b(0, 0, 255));
  }
  mesh.textures = {"no such file.png"};
  const render::Rendering plain = render::render(mesh, render::load_textures(mesh), facing(mesh, 20, 20), unlit());
  EXPECT_EQ(plain.image.at<cv::Vec3b>(10, 10), cv::Vec3b(204, 200, 200));
}

TEST(Rasterize, ColorsOfVerticesAndFaces) {
  Mesh mesh = square();
  mesh.face_color = {{10, 20, 30, 255}, {40, 50, 60, 255}};
  render::Rendering r = render::render(mesh, {}, facing(mesh, 40, 40), unlit());
  EXPECT_EQ(r.image.at<cv::Vec3b>(30, 25), cv::Vec3b(30, 20, 10));
  EXPECT_EQ(r.image.at<cv::Vec3b>(10, 15), cv::Vec3b(60, 50, 40));
  mesh.vertex_color = {{0, 0, 0, 255}, {200, 0, 0, 255}, {200, 0, 0, 255}, {0, 0, 0, 255}};
  r = render::render(mesh, {}, facing(mesh, 40, 40), unlit());
  EXPECT_NEAR(r.image.at<cv::Vec3b>(20, 20)[2], 100, 5);
  render::RenderOptions options = unlit();
  options.colors = false;
  options.base = {1, 2, 3, 255};
  r = render::render(mesh, {}, facing(mesh, 40, 40), options);
  EXPECT_EQ(r.image.at<cv::Vec3b>(20, 20), cv::Vec3b(3, 2, 1));
}

TEST(Rasterize, LightAndBackFaces) {
  const Mesh mesh = square();
  render::RenderOptions options;
  options.light.direction = {0, 0, 4};
  options.light.ambient = 0.25;
  options.base = {200, 200, 200, 255};
  const auto middle = [&](double yaw) {
    return render::render(mesh, {}, facing(mesh, 20, 20, yaw), options).image.at<cv::Vec3b>(10, 10);
  };
  EXPECT_EQ(middle(0), cv::Vec3b(200, 200, 200));
  EXPECT_NEAR(middle(60)[0], 200 * (0.25 + 0.75 * 0.5), 1);
  EXPECT_EQ(middle(180), cv::Vec3b(200, 200, 200));  // lit from both sides
  options.mark_back_faces = true;
  EXPECT_EQ(middle(0), cv::Vec3b(200, 200, 200));
  EXPECT_GT(middle(180)[2], middle(180)[0] + 50);
  options.light.direction = {0, 0, -1};
  EXPECT_NEAR(middle(0)[0], 50, 1);
}

TEST(Rasterize, EdgesAreDrawn) {
  const Mesh mesh = square();
  render::RenderOptions options = unlit();
  options.edge_width = 2;
  const render::Camera camera = facing(mesh, 100, 100);
  const render::Rendering r = render::render(mesh, {}, camera, options);
  EXPECT_LT(r.image.at<cv::Vec3b>(50, 50)[0], 120);  // the diagonal
  EXPECT_EQ(r.image.at<cv::Vec3b>(30, 60)[0], 204);
}

TEST(Rasterize, EqualDepthsGoToTheLowerFace) {
  Mesh mesh = square();
  mesh.faces.push_back(mesh.faces[0]);
  mesh.faces.push_back(mesh.faces[1]);
  const render::Rendering r = render::render(mesh, {}, facing(mesh, 30, 30), {});
  double most = 0;
  cv::minMaxLoc(r.face, nullptr, &most);
  EXPECT_EQ(most, 1);
}

TEST(Rasterize, NastyInputs) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  Mesh mesh = square();
  mesh.vertices.insert(mesh.vertices.end(), {{nan, 0, 0}, {0, inf, 0}, {1e300, 0, 0}, {0, 0, 1e6}, {0, 0, -1e6}});
  for (int v = 4; v < 9; ++v) mesh.faces.push_back({0, 1, v}), mesh.faces.push_back({v, v, v});
  render::Camera camera = facing(square(), 30, 30);
  EXPECT_EQ(render::render(mesh, {}, camera, {}).image.at<cv::Vec3b>(2, 2)[0],
            render::render(square(), {}, camera, {}).image.at<cv::Vec3b>(2, 2)[0]);
  camera = pinhole_camera(camera.rotation, square().bounds(), 30, 30, 40);
  render::render(mesh, {}, camera, {});  // a corner behind the eye
  camera.eye = {0, 0, 0};                // in the plane itself
  render::render(mesh, {}, camera, {});
  EXPECT_EQ(cv::countNonZero(render::render({}, {}, camera, {}).mask), 0);
  camera.width = 0;
  EXPECT_TRUE(render::render(mesh, {}, camera, {}).image.empty());
  mesh.wedges.assign(mesh.faces.size(), {});
  for (Wedges& w : mesh.wedges) w.texture = 7, w.uv[0] = {float(nan), 0};
  render::render(mesh, {}, facing(square(), 30, 30), {});
}

}  // namespace
}  // namespace parts
