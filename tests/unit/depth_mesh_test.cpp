// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/depth_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "parts/base/error.h"
#include "parts/io/raster_io.h"
#include "parts/mesh/topology.h"
#include "parts/render/rasterize.h"
#include "support/cameras.h"
#include "support/shapes.h"

namespace parts {
namespace {

using namespace parts::test;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

cv::Mat background(int width, int height) { return cv::Mat(height, width, CV_32F, cv::Scalar(kNaN)); }

void disc(cv::Mat& depth, double x, double y, double r, float z) {
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
      if (std::hypot(u - x, v - y) < r) depth.at<float>(v, u) = z;
}

render::DepthMesh mesh_of(const cv::Mat& depth, const cv::Mat& back = {}, double max_jump = 0, double focal = 0) {
  Progress progress;
  return render::depth_to_mesh(depth, back, render::raster_camera(depth.size(), 1, focal), {max_jump}, progress);
}

double volume(const Mesh& m) {
  double v = 0;
  for (int f = 0; f < m.face_count(); ++f) v += m.corner(f, 0).dot(m.corner(f, 1).cross(m.corner(f, 2))) / 6;
  return v;
}

/// Vertices in one place made one.
Mesh welded(const Mesh& m) {
  Mesh out;
  std::map<std::array<double, 3>, int> index;
  std::vector<int> of;
  for (const Vec3& v : m.vertices) {
    const auto [at, is_new] = index.emplace(std::array<double, 3>{v.x(), v.y(), v.z()}, int(out.vertices.size()));
    if (is_new) out.vertices.push_back(v);
    of.push_back(at->second);
  }
  for (const Triangle& f : m.faces) out.faces.push_back({of[f[0]], of[f[1]], of[f[2]]});
  return out;
}

void expect_closed(const Mesh& m) {
  const mesh::MeshCheck c = mesh::check(m);
  EXPECT_TRUE(c.closed() && c.manifold() && c.oriented()) << mesh::to_string(c);
  EXPECT_EQ(c.degenerate_faces, 0);
  EXPECT_EQ(c.unused_vertices, 0);
  const mesh::MeshCheck w = mesh::check(welded(m));
  EXPECT_TRUE(w.closed() && w.manifold() && w.oriented()) << "welded\n" << mesh::to_string(w);
  EXPECT_GT(volume(m), 0);
}

TEST(DepthMesh, APlaneFacesTheCamera) {
  const render::DepthMesh out = mesh_of(cv::Mat(4, 6, CV_32F, cv::Scalar(10)));
  const Mesh& m = out.mesh;
  EXPECT_EQ(m.vertex_count(), 24);
  EXPECT_EQ(m.face_count(), 2 * 5 * 3);
  EXPECT_EQ(m.bounds().min(), Vec3(-2.5, -1.5, -10));
  EXPECT_EQ(m.bounds().max(), Vec3(2.5, 1.5, -10));
  for (const Eigen::Vector3f& n : m.vertex_normal) EXPECT_LT((n - Eigen::Vector3f(0, 0, 1)).norm(), 1e-6);
  for (int f = 0; f < m.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {  // the image lies on it, its top up
      const Vec3 p = m.corner(f, k);
      EXPECT_NEAR(m.wedges[f].uv[k].x(), (p.x() + 3) / 6, 1e-6);
      EXPECT_NEAR(m.wedges[f].uv[k].y(), (p.y() + 2) / 4, 1e-6);
    }
  EXPECT_EQ(out.torn, 0);
}

TEST(DepthMesh, PinholeRaysSpread) {
  const render::DepthMesh out = mesh_of(cv::Mat(40, 60, CV_32F, cv::Scalar(10)), {}, 0, 50);
  EXPECT_NEAR(out.mesh.bounds().max().x(), 29.5 * 10 / 50, 1e-9);
  EXPECT_NEAR(out.mesh.bounds().max().y(), 19.5 * 10 / 50, 1e-9);
  EXPECT_NEAR(out.mesh.bounds().max().z(), -10, 1e-9);
}

TEST(DepthMesh, SeenThroughItsCameraItIsTheRaster) {
  const Mesh model = bust(3, 40);
  for (const bool pinhole : {false, true}) {
    const Eigen::Matrix3d rotation = render::view_rotation({30, 10}, {0, 1, 0}, {0, 0, 1});
    const render::Camera camera = pinhole ? pinhole_camera(rotation, model.bounds(), 90, 120, 150)
                                          : render::orthographic_camera(rotation, model.bounds(), 90, 120);
    const render::Rendering seen = render::render(model, {}, camera, {});
    Progress progress;
    const render::DepthMesh out = render::depth_to_mesh(seen.depth, {}, camera, {}, progress);
    const mesh::MeshCheck c = mesh::check(out.mesh);
    EXPECT_TRUE(c.manifold() && c.oriented()) << mesh::to_string(c);
    const render::Rendering again = render::render(out.mesh, {}, camera, {});
    int lost = 0;
    cv::Mat inside;
    cv::erode(seen.mask, inside, cv::Mat());
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 90; ++x) {
        const float a = seen.depth.at<float>(y, x), b = again.depth.at<float>(y, x);
        EXPECT_FALSE(std::isnan(a) && !std::isnan(b)) << "a fringe at " << x << " " << y;
        if (std::isnan(b) || std::isnan(a))
          lost += inside.at<uchar>(y, x) && std::isnan(a) != std::isnan(b);
        else
          EXPECT_NEAR(a, b, 1e-4 * camera.eye.norm()) << x << " " << y;
      }
    EXPECT_LT(lost, 0.01 * cv::countNonZero(inside)) << "only pixels at rims";
    for (int f = 0; f < out.mesh.face_count(); ++f) {
      const Vec3 &a = out.mesh.corner(f, 0), &b = out.mesh.corner(f, 1), &d = out.mesh.corner(f, 2);
      EXPECT_GT((b - a).cross(d - a).dot(camera.eye + 1e6 * camera.rotation.row(2).transpose() - a), 0);
      if (HasFailure()) return;
    }
  }
}

TEST(DepthMesh, TornWhereDepthJumps) {
  cv::Mat depth = background(60, 40);
  disc(depth, 30, 20, 18, 50);
  disc(depth, 38, 20, 9, 30);
  const render::DepthMesh torn = mesh_of(depth), asked = mesh_of(depth, {}, 5), whole = mesh_of(depth, {}, 25);
  EXPECT_EQ(mesh::check(torn.mesh).components, 2);
  EXPECT_EQ(mesh::check(asked.mesh).components, 2);
  EXPECT_EQ(mesh::check(whole.mesh).components, 1);
  EXPECT_EQ(torn.max_jump, 6) << "six pixels, as the range is small";
  EXPECT_EQ(whole.max_jump, 25);
  for (int f = 0; f < torn.mesh.face_count(); ++f) EXPECT_EQ(torn.mesh.corner(f, 0).z(), torn.mesh.corner(f, 1).z());
}

TEST(DepthMesh, PixelsBetweenTwoSurfacesAreNoSurface) {
  cv::Mat depth = background(80, 60);
  disc(depth, 40, 30, 26, 80);
  disc(depth, 45, 33, 14.4, 50);
  disc(depth, 45, 33, 13, 20);
  const render::DepthMesh out = mesh_of(depth);
  EXPECT_GT(out.dropped_faces, 0);
  EXPECT_EQ(mesh::check(out.mesh).components, 2);
  for (int f = 0; f < out.mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const double z = -out.mesh.corner(f, k).z();
      EXPECT_TRUE(z < 27 || z > 73) << z;
    }
}

TEST(DepthMesh, AThinThingStays) {
  cv::Mat depth = background(40, 40);
  depth(cv::Rect(5, 5, 2, 30)).setTo(7);  // two pixels wide, but alone
  EXPECT_EQ(mesh_of(depth).mesh.face_count(), 2 * 29);
}

TEST(DepthMesh, FansThatMeetInAPixelAreApart) {
  cv::Mat depth = background(9, 9);
  depth(cv::Rect(0, 0, 5, 5)).setTo(7);
  depth(cv::Rect(4, 4, 5, 5)).setTo(13);
  depth.at<float>(4, 4) = 10;
  const render::DepthMesh out = mesh_of(depth, {}, 4);
  const mesh::MeshCheck c = mesh::check(out.mesh);
  EXPECT_TRUE(c.manifold()) << mesh::to_string(c);
  EXPECT_EQ(c.vertices, 50);
  EXPECT_EQ(c.components, 2);
}

TEST(DepthSolid, ASphereIsClosed) {
  const Mesh model = sphere({0, 0, 0}, 1, 5);
  for (const double focal : {0., 200.}) {
    const render::Camera camera =
        focal > 0 ? pinhole_camera(Eigen::Matrix3d::Identity(), model.bounds(), 100, 100, focal)
                  : render::orthographic_camera(Eigen::Matrix3d::Identity(), model.bounds(), 100, 100);
    const render::Rendering seen = render::render(model, {}, camera, {});
    Progress progress;
    const render::DepthMesh out = render::depth_to_mesh(seen.depth, seen.back_depth, camera, {}, progress);
    expect_closed(out.mesh);
    EXPECT_EQ(mesh::check(out.mesh).components, 1);
    // A camera nearby does not see all of the back: a cone of rays takes its place.
    EXPECT_NEAR(volume(out.mesh) / volume(model), focal > 0 ? 0.87 : 0.985, focal > 0 ? 0.13 : 0.02);
    EXPECT_GT(out.walls, 0);
    EXPECT_EQ(out.back_before, 0);
    if (focal > 0) continue;
    for (int f = out.mesh.face_count() - out.walls; f < out.mesh.face_count(); ++f)
      for (int k = 0; k < 3; ++k) {
        const Vec3 side = camera.scale * (out.mesh.corner(f, k) - out.mesh.corner(f, (k + 1) % 3));
        EXPECT_TRUE(side.head<2>().norm() > 0.5 || side.norm() < 1.6) << "no tall walls: " << side.transpose();
      }
  }
}

TEST(DepthSolid, TornOnlyWhereThereIsNothingBetween) {
  cv::Mat front = background(60, 40), back = background(60, 40);
  disc(front, 25, 20, 15, 50), disc(back, 25, 20, 15, 70);
  cv::Mat near_front = front.clone(), near_back = back.clone();
  disc(near_front, 38, 20, 9, 10), disc(near_back, 38, 20, 9, 20);
  const render::DepthMesh apart = mesh_of(near_front, near_back);
  expect_closed(apart.mesh);
  EXPECT_EQ(mesh::check(apart.mesh).components, 2) << "an arm before a body";
  near_front = front.clone(), near_back = back.clone();
  disc(near_front, 25, 20, 6, 10);
  const render::DepthMesh nose = mesh_of(near_front, near_back);
  expect_closed(nose.mesh);
  EXPECT_EQ(mesh::check(nose.mesh).components, 1) << "a nose on a face";
}

TEST(DepthSolid, ThinAndReversedBacksGetAThickness) {
  cv::Mat front = background(30, 30), back = background(30, 30);
  disc(front, 15, 15, 10, 5), disc(back, 15, 15, 10, 5);
  back.at<float>(15, 15) = 2, back.at<float>(15, 16) = kNaN;
  const render::DepthMesh out = mesh_of(front, back);
  expect_closed(out.mesh);
  EXPECT_EQ(out.back_before, 2);
  EXPECT_EQ(out.mesh.bounds().min().z(), -5.5);
}

TEST(DepthSolid, AnyRasterGivesAManifold) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    cv::Mat front = background(17, 13), back = background(17, 13);
    const double cover = random.uniform(0.3, 0.95), rough = random.uniform(0, 20);
    for (int y = 0; y < 13; ++y)
      for (int x = 0; x < 17; ++x) {
        if (random.uniform(0, 1) > cover) continue;
        front.at<float>(y, x) = float(50 + random.uniform(-rough, rough));
        if (random.uniform(0, 1) < 0.9) back.at<float>(y, x) = float(52 + random.uniform(-rough, rough));
      }
    const double jump = random.uniform(0.1, 15), focal = seed % 2 ? 30 : 0;
    try {
      const mesh::MeshCheck sheet = mesh::check(mesh_of(front, {}, jump, focal).mesh);
      EXPECT_TRUE(sheet.manifold() && sheet.oriented() && sheet.unused_vertices == 0) << seed << mesh::to_string(sheet);
    } catch (const UserError&) {  // all torn
    }
    try {
      expect_closed(mesh_of(front, back, jump, focal).mesh);
    } catch (const UserError&) {
    }
    if (HasFailure()) FAIL() << "seed " << seed;
  }
}

TEST(DepthMesh, WhatCannotBeMeshed) {
  const auto says = [](const char* words, auto call) {
    try {
      call();
      ADD_FAILURE() << words;
    } catch (const UserError& e) {
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
    }
  };
  says("No three neighbouring", [] { mesh_of(background(5, 5)); });
  says("No three neighbouring", [] { mesh_of(cv::Mat(1, 9, CV_32F, cv::Scalar(3))); });
  says("negative", [] { mesh_of(cv::Mat(5, 5, CV_32F, cv::Scalar(-3)), {}, 0, 40); });
  says("4 x 5 pixels and the depth 5 x 5",
       [] { mesh_of(cv::Mat(5, 5, CV_32F, cv::Scalar(3)), cv::Mat(5, 4, CV_32F, cv::Scalar(3))); });
  EXPECT_EQ(mesh_of(cv::Mat(5, 5, CV_32F, cv::Scalar(-3))).mesh.face_count(), 32) << "orthographic: anywhere";
}

TEST(DepthMesh, CanBeCancelled) {
  Progress cancelling([](int percent, const char*) { return percent < 20; });
  const cv::Mat depth(200, 200, CV_32F, cv::Scalar(3));
  EXPECT_THROW(render::depth_to_mesh(depth, {}, render::raster_camera(depth.size(), 1, 0), {}, cancelling), Cancelled);
}

}  // namespace
}  // namespace parts
