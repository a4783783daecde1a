// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/background.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "parts/base/error.h"
#include "parts/render/depth_jump.h"
#include "parts/render/depth_mesh.h"
#include "parts/render/view_image.h"
#include "support/folder.h"

namespace parts {
namespace {

namespace fs = std::filesystem;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A ball before nothing, `background`; as a raster that may be filtered or quantised.
cv::Mat ball(float background, double nearest = 2, double radius = 1) {
  cv::Mat depth(60, 80, CV_32F, cv::Scalar(background));
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      const double r2 = (std::pow(x - 30, 2) + std::pow(y - 25, 2)) / (22. * 22.);
      if (r2 < 1) depth.at<float>(y, x) = float(nearest + radius * (1 - std::sqrt(1 - r2)));
    }
  return depth;
}

std::string bytes(const render::DepthMesh& m) {
  std::string all;
  for (const Vec3& v : m.mesh.vertices) all.append(reinterpret_cast<const char*>(v.data()), sizeof(Vec3));
  for (const Triangle& f : m.mesh.faces) all.append(reinterpret_cast<const char*>(f.data()), sizeof f);
  return all;
}

render::DepthMesh mesh_of(const cv::Mat& depth, double pixel = 1 / 22.) {
  Progress quiet;
  return render::depth_to_mesh(depth, {}, render::raster_camera(depth.size(), pixel, 0), {}, quiet);
}

TEST(Background, AFarPlateauGivesTheSameMeshAsNaN) {
  const std::string expected = bytes(mesh_of(ball(kNaN)));
  for (float far : {1e10f, 65504.f, 65535.f, 100.f, 10.f, std::numeric_limits<float>::max()}) {
    cv::Mat depth = ball(far), back;
    const render::RemovedBackground removed = render::remove_background({}, 1, depth, back);
    EXPECT_FLOAT_EQ(float(removed.value), far);
    EXPECT_EQ(removed.pixels, cv::countNonZero(ball(far) == far));
    EXPECT_EQ(bytes(mesh_of(depth)), expected) << far;
  }
}

TEST(Background, InAnyUnitAndBehindBothSides) {
  for (double scale : {0.001, -0.001}) {
    cv::Mat depth = ball(float(65535 * 0.001)), back = depth + 0.1;
    back.setTo(float(65535 * 0.001), depth == float(65535 * 0.001));
    if (scale < 0) depth.setTo(float(-1e7 * scale), depth > 60), back.setTo(float(-1e7 * scale), back > 60);
    const render::RemovedBackground removed = render::remove_background({}, scale, depth, back);
    EXPECT_NEAR(removed.value, scale > 0 ? 65535 : -1e7, 1);
    EXPECT_EQ(cv::countNonZero(~(depth == depth)), removed.pixels);
    EXPECT_EQ(cv::countNonZero((depth == depth) != (back == back)), 0);
  }
}

TEST(Background, WhatIsSeenIsNoBackground) {
  const auto found = [](const cv::Mat& depth) { return bool(render::find_background(depth)); };
  cv::Mat plates(40, 60, CV_32F, cv::Scalar(50));  // a wall behind a plate
  plates(cv::Rect(20, 10, 20, 20)).setTo(20);
  EXPECT_FALSE(found(plates));
  EXPECT_FALSE(found(cv::Mat(9, 9, CV_32F, cv::Scalar(7))));
  EXPECT_FALSE(found(cv::Mat(9, 9, CV_32F, cv::Scalar(kNaN))));
  cv::Mat slope(40, 60, CV_32F);
  for (int x = 0; x < 60; ++x) slope.col(x).setTo(std::min(x, 45));  // ends in a wall that it touches
  EXPECT_FALSE(found(slope));
  cv::Mat inside = ball(kNaN);  // a far plate in the middle does not border the image
  inside(cv::Rect(20, 20, 12, 12)).setTo(50);
  EXPECT_FALSE(found(inside));
  cv::Mat rough(60, 80, CV_32F);
  cv::RNG(3).fill(rough, cv::RNG::UNIFORM, 90, 110);  // a rough wall
  ball(0).copyTo(rough, ball(0) > 0);
  EXPECT_FALSE(found(rough));
  EXPECT_TRUE(found(ball(10)));
}

TEST(Background, FilteredRimsDoNotHideIt) {
  cv::Mat depth, back;
  cv::resize(ball(1000), depth, {120, 90}, 0, 0, cv::INTER_LINEAR);
  EXPECT_EQ(render::remove_background({}, 1, depth, back).value, 1000);
}

TEST(Background, AsTheUserSays) {
  EXPECT_TRUE(render::parse_background(" auto ").automatic);
  EXPECT_TRUE(render::parse_background("").automatic);
  EXPECT_FALSE(render::parse_background("none").automatic || render::parse_background("none").value);
  EXPECT_EQ(render::parse_background("1e10").value, 1e10);
  for (const char* bad : {"far", "1,2", "nan", "inf", "3 m"}) EXPECT_THROW(render::parse_background(bad), UserError);
  cv::Mat depth = ball(100), back;
  EXPECT_EQ(render::remove_background(render::parse_background("none"), 1, depth, back).pixels, 0);
  EXPECT_EQ(render::remove_background(render::parse_background("7"), 1, depth, back).pixels, 0);
  EXPECT_GT(render::remove_background(render::parse_background("100000"), 0.001, depth, back).pixels, 1000);
  cv::Mat all(5, 5, CV_32F, cv::Scalar(3));
  EXPECT_THROW(render::remove_background(render::parse_background("3"), 1, all, back), UserError);
}

TEST(DepthJump, DoesNotFollowTheRange) {
  // An object 0.3 before a wall; far beside it the ground runs to 80.
  cv::Mat depth(90, 120, CV_32F, cv::Scalar(3));
  for (int y = 60; y < 90; ++y) depth.row(y).setTo(3 + 77. * (y - 60) / 30 / 30);
  depth.row(89).setTo(80);
  cv::Mat object = depth(cv::Rect(20, 10, 30, 30));
  object.setTo(2.7f);
  const render::DepthMesh far = mesh_of(depth, 0.01);
  EXPECT_LT(far.max_jump, 0.3);
  EXPECT_GT(far.torn, 200);
}

TEST(DepthJump, FollowsNoiseAndUnits) {
  cv::Mat noise(60, 80, CV_32F), flat(60, 80, CV_32F, cv::Scalar(5));
  cv::RNG(1).fill(noise, cv::RNG::NORMAL, 5, 0.1);
  EXPECT_EQ(mesh_of(noise, 0.001).torn, 0) << "noise of many pixels' width is one surface";
  const render::Camera camera = render::raster_camera(flat.size(), 0.01, 0);
  EXPECT_NEAR(render::automatic_jump(flat, camera), 0.06, 1e-9);
  EXPECT_EQ(render::automatic_jump(cv::Mat(4, 4, CV_32F, cv::Scalar(kNaN)), camera), 0);
}

struct ViewImages : test::Folder {
  std::string saved(int width, int height, const char* name = "a.png") const {
    cv::Mat image(height, width, CV_8UC3, cv::Scalar(9, 9, 9));
    image.rowRange(0, height / 3).setTo(cv::Scalar(200, 0, 0));
    EXPECT_TRUE(cv::imwrite((folder / name).string(), image));
    return (folder / name).string();
  }
  /// The bytes of an EXIF block that says how the camera was held, put into a JPEG.
  std::string held(int width, int height, char orientation) const {
    const std::string path = saved(width, height, "held.jpg");
    std::ifstream in(path, std::ios::binary);
    std::string data((std::istreambuf_iterator<char>(in)), {});
    in.close();
    std::string exif("Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0", 24);
    exif += std::string{orientation, 0, 0, 0, 0, 0, 0, 0};
    const auto size = exif.size() + 2;
    data.insert(2, std::string("\xff\xe1", 2) + char(size >> 8) + char(size & 255) + exif);
    std::ofstream(path, std::ios::binary) << data;
    return path;
  }
};

TEST_F(ViewImages, ASensorsOwnPairFits) {
  const cv::Size depth(848, 480);
  for (const cv::Size size : {cv::Size(1280, 720), cv::Size(1920, 1080)})
    EXPECT_NEAR(render::read_view_image(saved(size.width, size.height), depth).off, 0.0063, 1e-4);
  EXPECT_EQ(render::read_view_image(saved(848, 480), depth).off, 0);
  EXPECT_THROW(render::read_view_image(saved(640, 480), depth), UserError);
  EXPECT_THROW(render::read_view_image(saved(848, 470), depth), UserError);
}

TEST_F(ViewImages, OneScaleAboutTheMiddle) {
  Mesh mesh;
  mesh.wedges.resize(1);
  mesh.wedges[0].uv = {Eigen::Vector2f(0.1f, 0.5f), Eigen::Vector2f(0.2f, 0.75f), Eigen::Vector2f(0.9f, 1)};
  render::fit_texture(mesh, {848, 480}, {1280, 720});
  EXPECT_EQ(mesh.wedges[0].uv[0].y(), 0.5f);
  // 120 rows of the depth above the middle are 120 * 1280 / 848 of the image.
  EXPECT_NEAR(mesh.wedges[0].uv[1].y(), 0.5 + 120 * 1280. / 848 / 720, 1e-6);
  EXPECT_LT(mesh.wedges[0].uv[2].y(), 1);
  EXPECT_EQ(mesh.wedges[0].uv[1].x(), 0.2f);
}

TEST_F(ViewImages, OrientationTagsAreTakenForWhatTheDepthIs) {
  using Held = render::ViewImage::Held;
  const auto top_is_blue = [](const cv::Mat& image) { return image.at<cv::Vec3b>(2, image.cols / 2)[0] > 150; };
  render::ViewImage as_stored = render::read_view_image(held(160, 120, 3), {160, 120});
  EXPECT_EQ(as_stored.held, Held::AsStored);
  EXPECT_TRUE(top_is_blue(as_stored.image.color));
  as_stored = render::read_view_image(held(160, 120, 6), {160, 120});
  EXPECT_EQ(as_stored.held, Held::AsStored);
  EXPECT_TRUE(top_is_blue(as_stored.image.color));
  const render::ViewImage turned = render::read_view_image(held(160, 120, 6), {120, 160});
  EXPECT_EQ(turned.held, Held::Turned);
  EXPECT_EQ(turned.image.color.size(), cv::Size(120, 160));
  EXPECT_EQ(render::read_view_image(held(160, 120, 1), {160, 120}).held, Held::NotSaid);
}

}  // namespace
}  // namespace parts
