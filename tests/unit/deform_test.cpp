// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/deform.h"

#include "parts/mesh/attributes.h"
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

TEST(Deform, ThirtyBendsOfAHand) {
  // Five fingers, each bent at its middle at six angles toward the palm.
  std::vector<Limb> limbs{{{{0, -0.5, 0}, 0.35}, {{0, 0.1, 0}, 0.4}}};
  std::vector<Vec3> base, tip;
  for (int k = 0; k < 5; ++k) {
    const double spread = 0.45 * (k - 2);
    base.push_back({0.3 * (k - 2), 0.3, 0});
    tip.push_back(base.back() + 1.1 * Vec3(std::sin(spread), std::cos(spread), 0));
    limbs.push_back({{base.back(), 0.14}, {tip.back(), 0.1}});
  }
  const Mesh hand = blend(limbs, 0.05, 72);
  ASSERT_EQ(mesh::self_intersections(hand), 0);
  Arm a;
  a.mesh = hand;
  a.fixed = faces_where(hand, [](const Vec3& c) { return c.y() < -0.3; });
  for (int k = 0; k < 5; ++k) {
    a.moving = faces_where(hand, [&](const Vec3& c) { return (c - tip[k]).norm() < 0.2; });
    for (double angle = 15; angle <= 90; angle += 15) {
      const std::string what = "finger " + std::to_string(k) + " by " + std::to_string(angle);
      compose::RigidPose pose;
      pose.pivot = 0.5 * (base[k] + tip[k]);
      pose.axis = (tip[k] - base[k]).cross(Vec3::UnitZ());
      pose.angle = angle;
      const compose::ComposeResult r = bend(a, pose)[0];
      // One surface, the input's own: no limb comes twice, none is lost.
      EXPECT_EQ(r.composed.faces, hand.faces) << what;
      EXPECT_EQ(mesh::self_intersections(r.composed, 10), 0) << what;
      const Eigen::AngleAxisd turn(angle * M_PI / 180, pose.axis.normalized());
      long moved = 0, rest = 0;
      for (int v = 0; v < hand.vertex_count(); ++v) {
        const Vec3& p = hand.vertices[v];
        moved += (r.composed.vertices[v] - (pose.pivot + turn * (p - pose.pivot))).norm() < 1e-9;
        rest += r.composed.vertices[v] == p;
        // No other finger follows.
        for (int other = 0; other < 5; ++other)
          if (other != k && (p - tip[other]).norm() < 0.2) {
            EXPECT_EQ(r.composed.vertices[v], p) << what;
          }
      }
      for (int f = 0; f < hand.face_count(); ++f)
        for (int c : hand.faces[f]) {
          const Vec3 &was = hand.vertices[c], &is = r.composed.vertices[c];
          if (a.fixed[f]) {
            EXPECT_EQ(is, was) << what;
          }
          if (a.moving[f]) {
            EXPECT_LT((is - (pose.pivot + turn * (was - pose.pivot))).norm(), 1e-9) << what;
          }
        }
      EXPECT_GT(moved, 20) << what;
      EXPECT_GT(rest, hand.vertex_count() * 3 / 4) << what;
    }
  }
}

TEST(Deform, BordersAndSeamsOfTheTextureStay) {
  // An arm open at the shoulder, its vertices doubled along a line as by a texture's seam.
  Arm a = arm();
  std::vector<char> flags = faces_where(a.mesh, [](const Vec3& c) { return c.x() > -1.9; });
  a.mesh = mesh::take_faces(a.mesh, flags);
  const int doubled = a.mesh.vertex_count();
  a.mesh.vertices.insert(a.mesh.vertices.end(), a.mesh.vertices.begin(), a.mesh.vertices.end());
  for (int f = 0; f < a.mesh.face_count(); ++f)
    if (a.mesh.center(f).z() > 0)
      for (int& v : a.mesh.faces[f]) v += doubled;
  a.fixed = faces_where(a.mesh, [](const Vec3& c) { return c.x() < -1; });
  a.moving = faces_where(a.mesh, [](const Vec3& c) { return c.x() > 1; });
  compose::RigidPose pose;
  pose.angle = 45;
  const Mesh m = bend(a, pose)[0].composed;
  EXPECT_EQ(m.faces, a.mesh.faces);
  for (int v = 0; v < doubled; ++v) EXPECT_EQ(m.vertices[v], m.vertices[v + doubled]);
  EXPECT_EQ(mesh::check(m).boundary_loops, mesh::check(a.mesh).boundary_loops);
}

TEST(Deform, ALooseEyeFollowsItsHead) {
  Arm a = arm();
  const int faces = a.mesh.face_count(), vertices = a.mesh.vertex_count();
  a.mesh = together({a.mesh, sphere({1.5, 0, 0.2}, 0.1, 1), sphere({-1.5, 0, 0.2}, 0.1, 1)});
  a.fixed.resize(a.mesh.faces.size(), 0), a.moving.resize(a.mesh.faces.size(), 0);
  compose::RigidPose pose;
  pose.angle = 90;
  const Mesh m = bend(a, pose)[0].composed;
  EXPECT_EQ(m.faces, a.mesh.faces);
  const int each = (a.mesh.vertex_count() - vertices) / 2;
  for (int v = vertices; v < vertices + each; ++v) {
    const Vec3& p = a.mesh.vertices[v];
    EXPECT_LT((m.vertices[v] - Vec3(-p.y(), p.x(), p.z())).norm(), 1e-9);
    EXPECT_EQ(m.vertices[v + each], a.mesh.vertices[v + each]);
  }
  EXPECT_GT(faces, 0);
}

TEST(Deform, AFaceCannotBothStayAndMove) {
  Arm a = arm();
  a.fixed = a.moving;
  EXPECT_NE(user_error([&] { bend(a, {}); }).find("both to stay and to move"), std::string::npos);
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
