// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/deform.h"

#include "unit/compose_support.h"

namespace parts::test {
namespace {

/// A straight arm along x from -2 to 2, its ends to be kept.
struct Arm {
  Mesh mesh;
  std::vector<char> fixed, moving;
};

Arm arm() {
  Arm a;
  std::vector<Ball> path;
  for (int i = 0; i <= 40; ++i) path.push_back({{-2 + 0.1 * i, 0, 0}, 0.4});
  a.mesh = tube(path, 32);
  a.fixed = faces_where(a.mesh, [](const Vec3& c) { return c.x() < -1; });
  a.moving = faces_where(a.mesh, [](const Vec3& c) { return c.x() > 1; });
  return a;
}

std::vector<compose::ComposeResult> bend(const Arm& a, const compose::RigidPose& pose, int frames = 1) {
  Progress silent;
  return compose::deform(a.mesh, a.fixed, a.moving, pose, frames, {}, silent);
}

TEST(Deform, BendsAnArm) {
  const Arm a = arm();
  compose::RigidPose pose;
  pose.angle = 60;
  const std::vector<compose::ComposeResult> results = bend(a, pose);
  ASSERT_EQ(results.size(), 1u);
  const Mesh& m = results[0].composed;
  expect_closed_manifold(m, "bent arm");
  EXPECT_EQ(mesh::check(m).components, 1);
  EXPECT_EQ(mesh::check(m).euler, 2);
  // The hand is where the rotation takes it, and the shoulder has not moved.
  double hand = 1e9;
  for (const Vec3& v : m.vertices) hand = std::min(hand, (v - Vec3(1.2, 1.2 * std::sqrt(3.), 0)).norm());
  EXPECT_LT(hand, 1e-6);
  const std::set<FaceKey> keys = face_keys(m);
  for (int f = 0; f < a.mesh.face_count(); ++f) EXPECT_TRUE(!a.fixed[f] || keys.count(face_key(a.mesh, f)));
  EXPECT_NEAR(volume_of(m), volume_of(a.mesh), 0.15 * volume_of(a.mesh));
}

TEST(Deform, FramesLeadFromRestToThePose) {
  const Arm a = arm();
  compose::RigidPose pose;
  pose.angle = 40;
  const std::vector<compose::ComposeResult> frames = bend(a, pose, 4);
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_EQ(frames[0].composed.vertices, a.mesh.vertices);
  EXPECT_EQ(frames[0].composed.faces, a.mesh.faces);
  const Mesh last = bend(a, pose)[0].composed;
  EXPECT_EQ(frames[3].composed.vertices, last.vertices);
  double before = -1;
  for (const compose::ComposeResult& frame : frames) {
    expect_closed_manifold(frame.composed, "frame");
    const double height = frame.composed.bounds().max().y();
    EXPECT_GT(height, before);
    before = height;
  }
}

TEST(Deform, TranslatesScalesAndMirrors) {
  const Arm a = arm();
  compose::RigidPose pull;
  pull.translation = {0.8, 0, 0};
  EXPECT_NEAR(bend(a, pull)[0].composed.bounds().max().x(), a.mesh.bounds().max().x() + 0.8, 1e-9);
  compose::RigidPose grow;
  grow.scale = 1.3;
  const Mesh grown = bend(a, grow)[0].composed;
  expect_closed_manifold(grown, "scaled");
  EXPECT_NEAR(grown.bounds().max().x(), 1.3 * a.mesh.bounds().max().x(), 1e-9);
  compose::RigidPose mirror;
  mirror.mirror = true;
  const compose::ComposeResult mirrored = bend(a, mirror)[0];
  expect_closed_manifold(mirrored.composed, "mirrored");
  EXPECT_FALSE(mirrored.report.reversed_b);
  EXPECT_GT(volume_of(mirrored.composed), 0);
}

TEST(Deform, TheZeroPoseGivesTheModelBack) {
  const Arm a = arm();
  const Mesh m = bend(a, {})[0].composed;
  expect_closed_manifold(m, "zero pose");
  EXPECT_NEAR(volume_of(m), volume_of(a.mesh), 1e-2 * volume_of(a.mesh));
}

TEST(Deform, PosesThatAreNone) {
  const Arm a = arm();
  const auto sentence = [&](const std::function<void(compose::RigidPose&)>& set, int frames = 1) {
    compose::RigidPose pose;
    set(pose);
    return user_error([&] { bend(a, pose, frames); });
  };
  const double nan = std::nan("");
  EXPECT_NE(sentence([](auto& p) { p.axis.setZero(); }).find("axis"), std::string::npos);
  EXPECT_NE(sentence([&](auto& p) { p.axis.x() = nan; }).find("axis"), std::string::npos);
  EXPECT_NE(sentence([](auto& p) { p.scale = 0; }).find("scale"), std::string::npos);
  EXPECT_NE(sentence([](auto& p) { p.scale = -1; }).find("scale"), std::string::npos);
  EXPECT_NE(sentence([&](auto& p) { p.scale = nan; }).find("scale"), std::string::npos);
  EXPECT_NE(sentence([&](auto& p) { p.angle = nan; }).find("finite"), std::string::npos);
  EXPECT_NE(sentence([&](auto& p) { p.pivot.y() = nan; }).find("finite"), std::string::npos);
  EXPECT_NE(sentence([](auto&) {}, 0).find("Frames"), std::string::npos);
}

TEST(Deform, CancelsBetweenFrames) {
  const Arm a = arm();
  compose::RigidPose pose;
  pose.angle = 30;
  int calls = 0;
  Progress progress([&](int, const char*) { return ++calls < 4; });
  EXPECT_THROW(compose::deform(a.mesh, a.fixed, a.moving, pose, 6, {}, progress), Cancelled);
  int last = 0;
  Progress forward([&](int percent, const char*) {
    EXPECT_LE(percent, 100);
    last = percent;
    return true;
  });
  compose::deform(a.mesh, a.fixed, a.moving, pose, 3, {}, forward);
  EXPECT_EQ(last, 100);
}

}  // namespace
}  // namespace parts::test
