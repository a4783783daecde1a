// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/camera.h"

#include <gtest/gtest.h>

#include "parts/base/error.h"
#include "support/cameras.h"

namespace parts {
namespace {

TEST(Camera, ParsesViews) {
  const std::vector<render::View> views = render::parse_views(" 0,0; -40 , +15.5;180;");
  ASSERT_EQ(views.size(), 3u);
  EXPECT_EQ(views[1].yaw, -40);
  EXPECT_EQ(views[1].pitch, 15.5);
  EXPECT_EQ(views[2].yaw, 180);
  EXPECT_EQ(views[2].pitch, 0);
  for (const char* bad : {"", ";;", "a,b", "1,2,3", "1,", "nan,0", "1 2"})
    EXPECT_THROW(render::parse_views(bad), UserError) << bad;
}

TEST(Camera, ViewsTurnTheViewer) {
  const Vec3 up(0, 2, 0), front(0, 0, 5);
  const auto towards_viewer = [&](double yaw, double pitch) {
    return Vec3(render::view_rotation({yaw, pitch}, up, front).row(2).transpose());
  };
  EXPECT_TRUE(towards_viewer(0, 0).isApprox(Vec3(0, 0, 1)));
  EXPECT_TRUE(towards_viewer(90, 0).isApprox(Vec3(1, 0, 0)));
  EXPECT_TRUE(towards_viewer(0, 90).isApprox(Vec3(0, 1, 0)));
  EXPECT_TRUE(towards_viewer(180, 0).isApprox(Vec3(0, 0, -1)));
  for (double yaw : {0., 33., 200.})
    for (double pitch : {-90., -20., 70.}) {
      const Eigen::Matrix3d r = render::view_rotation({yaw, pitch}, up, front);
      EXPECT_TRUE((r * r.transpose()).isIdentity(1e-12));
      EXPECT_NEAR(r.determinant(), 1, 1e-12);
    }
  EXPECT_TRUE(render::view_rotation({0, 0}, {0, 0, 1}, {0, -1, 0}).row(0).isApprox(Eigen::RowVector3d(1, 0, 0)));
  EXPECT_THROW(render::view_rotation({}, {0, 1, 0}, {0, -3, 0}), UserError);
  EXPECT_THROW(render::view_rotation({}, {0, 0, 0}, {0, 0, 1}), UserError);
}

TEST(Camera, ProjectsThereAndBack) {
  const Eigen::Matrix3d r = render::view_rotation({30, 20}, {0, 1, 0}, {0, 0, 1});
  const Box box(Vec3(-1, -2, -3), Vec3(4, 5, 6));
  for (const render::Camera& camera :
       {render::orthographic_camera(r, box, 150, 200), pinhole_camera(r, box, 150, 200, 300)})
    for (int c = 0; c < 8; ++c) {
      const Vec3 p = box.corner(Box::CornerType(c)), q = camera.project(p);
      EXPECT_TRUE(camera.unproject(q.x(), q.y(), q.z()).isApprox(p, 1e-9));
      EXPECT_GT(q.z(), 0);
      EXPECT_GE(q.x(), 0);
      EXPECT_GE(q.y(), 0);
      EXPECT_LE(q.x(), 150);
      EXPECT_LE(q.y(), 200);
    }
}

TEST(Camera, FramesTightly) {
  const Box box(Vec3(-1, -1, -1), Vec3(1, 1, 1));
  const render::Camera camera = render::orthographic_camera(Eigen::Matrix3d::Identity(), box, 100, 200, 0.1);
  EXPECT_NEAR(camera.project({1, 0, 0}).x(), 90, 1e-9);
  EXPECT_NEAR(camera.project({0, 1, 0}).y(), 60, 1e-9);  // y runs down
  EXPECT_NEAR(camera.project({0, 0, -1}).z() - camera.project({0, 0, 1}).z(), 2, 1e-9);
  const render::Camera empty = render::orthographic_camera(Eigen::Matrix3d::Identity(), Box(), 10, 10);
  EXPECT_TRUE(std::isfinite(empty.scale) && empty.eye.allFinite());
  EXPECT_TRUE(
      std::isfinite(render::orthographic_camera(Eigen::Matrix3d::Identity(), Box(Vec3(1, 1, 1)), 10, 10).scale));
}

}  // namespace
}  // namespace parts
