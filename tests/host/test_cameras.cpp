// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras as the host's shots, and back.
#include <gtest/gtest.h>

#include "parts/host/cameras.h"
#include "support/cameras.h"

namespace parts::host {
namespace {

render::Camera some_camera(bool pinhole) {
  const Eigen::Matrix3d rotation = render::view_rotation({30, 20}, {0, 1, 0}, {0, 0, 1});
  const Box box(Vec3(-1, -2, -1), Vec3(1, 2, 3));
  render::Camera camera =
      pinhole ? pinhole_camera(rotation, box, 150, 200, 300) : render::orthographic_camera(rotation, box, 150, 200);
  camera.center += Eigen::Vector2d(3, -7);
  return camera;
}

TEST(Cameras, TheHostProjectsAsWeDo) {
  for (const bool pinhole : {false, true}) {
    const render::Camera camera = some_camera(pinhole);
    const Shotm shot = to_shot(camera, 5);
    EXPECT_TRUE(shot.IsValid());
    for (const Vec3& p : {Vec3(0.3, -0.7, 0.2), Vec3(-1, 2, 1), Vec3(0, 0, 0)}) {
      const Point3m q(p.x(), p.y(), p.z());
      const vcg::Point2<Scalarm> pixel = shot.Project(q);
      const Vec3 ours = camera.project(p);
      EXPECT_NEAR(pixel.X(), ours.x(), 1e-3);
      EXPECT_NEAR(200 - pixel.Y(), ours.y(), 1e-3);
      EXPECT_NEAR(shot.Depth(q), ours.z(), 1e-4);
    }
  }
}

TEST(Cameras, ComeBack) {
  for (const bool pinhole : {false, true}) {
    const render::Camera camera = some_camera(pinhole);
    const std::optional<render::Camera> back = to_camera(to_shot(camera, 5));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->width, 150);
    EXPECT_EQ(back->height, 200);
    EXPECT_NEAR(back->focal, camera.focal, 1e-3);
    const Vec3 p(0.5, -1, 0.7);
    EXPECT_LT((back->project(p) - camera.project(p)).norm(), 1e-3);
  }
  EXPECT_FALSE(to_camera(Shotm())) << "never set";
}

TEST(Cameras, OfALayer) {
  MeshDocument document;
  MeshModel* layer = document.addNewMesh("", "one");
  set_camera(some_camera(true), *layer);
  EXPECT_TRUE(layer->hasDataMask(MeshModel::MM_CAMERA));
  EXPECT_TRUE(to_camera(layer->cm.shot));
}

}  // namespace
}  // namespace parts::host
