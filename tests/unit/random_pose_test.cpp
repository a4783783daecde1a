// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "parts/align/align.h"
#include "parts/compose/deform.h"
#include "parts/mesh/attributes.h"
#include "parts/spatial/closest_face.h"
#include "unit/random_support.h"

namespace parts::test {
namespace {

/// What a scene is made simpler by: its members, one at a time.
template <class Scene, class... Changes>
std::vector<Scene> changed(const Scene& scene, const Changes&... changes) {
  std::vector<Scene> all;
  const auto add = [&](const auto& change) {
    Scene s = scene;
    if (change(s)) all.push_back(s);
  };
  (add(changes), ...);
  return all;
}

/// A change that sets a member where it is something else.
template <class Scene, class T>
auto set(T Scene::*member, T value) {
  return [member, value](Scene& s) {
    const bool other = s.*member != value;
    s.*member = value;
    return other;
  };
}

// --- Deform.

/// A limb of several joints; one of them bends.
struct LimbScene {
  unsigned seed = 0;
  int joints = 3, around = 16;
  double bumps = 0.1, angle = 0, scale = 1, shift = 0, size = 1;  ///< degrees; the shift in thicknesses
  bool mirror = false, colors = false, texture = false;

  std::string describe() const {
    return std::to_string(joints) + " joints, " + std::to_string(around) + " around, bumps " + std::to_string(bumps) +
           ", angle " + std::to_string(angle) + ", scale " + std::to_string(scale) + ", shift " +
           std::to_string(shift) + ", size " + std::to_string(size) + (mirror ? ", mirrored" : "") +
           (colors ? ", colours" : "") + (texture ? ", a texture" : "");
  }
};

LimbScene limb_scene(unsigned seed) {
  Random random(seed);
  LimbScene s;
  s.seed = seed;
  s.joints = 1 + random.below(4), s.around = 10 + random.below(16);
  s.bumps = random.uniform(0, 0.15);
  s.angle = random.uniform(-90, 90);
  s.scale = random.below(3) ? 1 : random.uniform(0.8, 1.25);
  s.shift = random.below(3) ? 0 : random.uniform(0, 0.3);
  s.size = random.below(3) ? 1 : std::pow(10, random.uniform(-3, 3));
  s.mirror = random.below(6) == 0;
  s.colors = random.below(2), s.texture = random.below(2);
  return s;
}

std::vector<LimbScene> simpler(const LimbScene& scene) {
  using S = LimbScene;
  return changed(scene, set(&S::joints, 1), set(&S::bumps, 0.), set(&S::scale, 1.), set(&S::shift, 0.),
                 set(&S::size, 1.), set(&S::mirror, false), set(&S::colors, false), set(&S::texture, false),
                 set(&S::around, 10));
}

/// A model to be bent.
struct Posed {
  Mesh mesh;
  std::vector<char> fixed, moving;
  compose::RigidPose pose;
};

Posed limb_of(const LimbScene& s) {
  Random random(s.seed + 1);
  std::vector<Ball> path;
  Vec3 at = Vec3::Zero(), along = random.direction();
  Vec3 joint = at;
  const int bends = random.below(s.joints);
  const double thick = 0.4;
  for (int j = 0; j <= s.joints; ++j) {
    const Vec3 next = at + 1.6 * along;
    for (int i = 0; i < 16; ++i)
      path.push_back({at + (next - at) * i / 16., thick * (1 + s.bumps * std::sin(2.1 * i + j))});
    if (j == bends) joint = next;
    at = next;
    along = (along + 0.25 * random.direction()).normalized();
  }
  path.push_back({at, thick});
  Posed limb;
  limb.mesh = tube(path, s.around);
  const Vec3 start = path.front().center, way = (at - start).normalized();
  const double reach = way.dot(joint - start), whole = (at - start).norm();
  limb.fixed = faces_where(limb.mesh, [&](const Vec3& c) { return way.dot(c - start) < reach - 1.1 * thick - 0.2; });
  limb.moving = faces_where(
      limb.mesh, [&](const Vec3& c) { return way.dot(c - start) > std::min(reach + 1.1 * thick + 0.2, whole - 0.3); });
  limb.pose.pivot = joint;
  limb.pose.axis = way.cross(random.direction()).normalized();
  limb.pose.angle = s.angle;
  limb.pose.scale = s.scale, limb.pose.mirror = s.mirror;
  limb.pose.translation = s.shift * thick * random.direction();
  if (s.mirror) limb.pose.axis = way.unitOrthogonal();  // through a plane along the limb
  for (Vec3& p : limb.mesh.vertices) p *= s.size;
  limb.pose.pivot *= s.size, limb.pose.translation *= s.size;
  limb.mesh = mesh::in_single_precision(limb.mesh);
  dress(limb.mesh, s.colors, s.texture);
  return limb;
}

Eigen::Affine3d map_of(const compose::RigidPose& pose) {
  const Vec3 axis = pose.axis.normalized();
  Eigen::Matrix3d linear = Eigen::AngleAxisd(pose.angle * M_PI / 180, axis).toRotationMatrix() * pose.scale;
  if (pose.mirror) linear *= Eigen::Matrix3d::Identity() - 2 * axis * axis.transpose();
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() = linear;
  map.translation() = pose.pivot - linear * pose.pivot + pose.translation;
  return map;
}

std::string broken_pose(const Posed& limb, SceneTally& tally) {
  std::vector<compose::ComposeResult> results;
  try {
    Progress silent;
    results = compose::deform(limb.mesh, limb.fixed, limb.moving, limb.pose, 1, {}, silent);
  } catch (const UserError&) {
    ++tally.refused;
    return {};
  }
  const Mesh& m = results.at(0).composed;
  mesh::check_arrays(m);
  const mesh::MeshCheck c = mesh::check(m);
  if (!c.closed() || !c.manifold() || !c.oriented() || c.nonfinite_vertices + c.unused_vertices > 0)
    return mesh::to_string(c);
  mesh::ResultRules rules;
  rules.moved = true;
  tally.flawless += worse_than({limb.mesh}, m, rules).empty();
  const std::set<FaceKey> kept = face_keys(m);
  for (int f = 0; f < limb.mesh.face_count(); ++f)
    if (limb.fixed[f] && !kept.count(face_key(limb.mesh, f))) return "a fixed face has changed";
  const Eigen::Affine3d map = map_of(limb.pose);
  const double size = limb.mesh.bounds().diagonal().norm();
  const spatial::ClosestFace result(m);
  for (int f = 0; f < limb.mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k)
      if (limb.moving[f] && result(map * limb.mesh.corner(f, k)).distance > 1e-9 * size)
        return "a moving face is not where the pose takes it";
  Box room = limb.mesh.bounds();
  room.extend(mesh::transformed(limb.mesh, map).bounds());
  const Vec3 around = Vec3::Constant(0.1 * size);
  if (!Box(room.min() - around, room.max() + around).contains(m.bounds())) return "a vertex out of bounds";
  if (const std::string what = dressed_otherwise(limb.mesh, m); !what.empty()) return what;
  if (!limb.mesh.vertex_color.empty() && m.vertex_color.empty()) return "the colours are gone";
  return {};
}

TEST(RandomScenes, Deform) {
  const SceneTally tally = check_scenes(
      200, limb_scene, [](const LimbScene& s, SceneTally& t) { return broken_pose(limb_of(s), t); },
      [](const LimbScene& s) { return simpler(s); });
  EXPECT_EQ(tally.refused, 0);
  EXPECT_GE(tally.share(tally.flawless), 0.96);  // as on 2026-11-25
}

/// A whole body, bent where it need not have a joint: the cut passes whatever lies between its ends.
struct BodyScene {
  unsigned seed = 0;
  int body = 0, cells = 24;
  double angle = 0, share = 0.2;  ///< degrees; of the area, fixed and moving each

  std::string describe() const {
    return "body " + std::to_string(body) + " of " + std::to_string(cells) + " cells, angle " + std::to_string(angle) +
           ", share " + std::to_string(share);
  }
};

BodyScene body_scene(unsigned seed) {
  Random random(seed);
  BodyScene s;
  s.seed = seed;
  s.body = random.below(4), s.cells = 22 + random.below(8);
  s.angle = random.uniform(-30, 30), s.share = random.uniform(0.1, 0.3);
  return s;
}

Mesh body_of(const BodyScene& s) {
  switch (s.body) {
    case 0:
      return animal(s.cells);
    case 1:
      return man(s.cells);
    case 2:
      return bush(s.seed, s.cells);
    default:
      return noisy_sphere(Vec3::Zero(), 1, 4, 0.5, s.seed);
  }
}

Posed posed_body(const BodyScene& s) {
  Random random(s.seed + 1);
  Posed p;
  p.mesh = mesh::in_single_precision(body_of(s));
  const Vec3 size = p.mesh.bounds().sizes();
  Vec3 way = random.direction();
  if (random.below(2)) way = Vec3::Unit(random.below(3));
  p.fixed = share_along(p.mesh, -way, s.share), p.moving = share_along(p.mesh, way, s.share);
  p.pose.pivot = p.mesh.bounds().center() + 0.1 * size.norm() * random.direction();
  p.pose.axis = way.cross(random.direction()).normalized();
  p.pose.angle = s.angle;
  return p;
}

TEST(RandomScenes, DeformBodies) {
  const SceneTally tally = check_scenes(
      80, body_scene, [](const BodyScene& s, SceneTally& t) { return broken_pose(posed_body(s), t); },
      [](const BodyScene& s) {
        using S = BodyScene;
        return changed(s, set(&S::body, 3), set(&S::cells, 22), set(&S::share, 0.2));
      });
  EXPECT_EQ(tally.refused, 0);
  EXPECT_GE(tally.share(tally.flawless), 0.8);  // 687 of 800 on 2026-11-25
}

// --- Align.

/// A part of a shape, meshed anew and moved away.
struct PartScene {
  unsigned seed = 0;
  int shape = 0;
  double share = 1, noise = 0, scale = 1;  ///< of the area; of the size; the part is so many times as large
  bool mirror = false, same_mesh = false;

  std::string describe() const {
    return "shape " + std::to_string(shape) + ", share " + std::to_string(share) + ", noise " + std::to_string(noise) +
           ", scale " + std::to_string(scale) + (mirror ? ", mirrored" : "") + (same_mesh ? ", the same mesh" : "");
  }
};

constexpr int kUneven = 3;

PartScene part_scene(unsigned seed) {
  Random random(seed);
  PartScene s;
  s.seed = seed;
  s.shape = random.below(4);
  s.share = random.below(3) ? random.uniform(0.35, 0.9) : 1;
  s.noise = random.below(2) ? random.uniform(0, 0.004) : 0;
  s.scale = random.below(3) ? 1 : random.uniform(0.5, 2);
  s.mirror = s.shape == kUneven && random.below(2);  // the others are much like their mirror images
  s.same_mesh = random.below(2);
  return s;
}

std::vector<PartScene> simpler(const PartScene& scene) {
  using S = PartScene;
  return changed(scene, set(&S::share, 1.), set(&S::noise, 0.), set(&S::scale, 1.), set(&S::mirror, false),
                 set(&S::same_mesh, true));
}

/// The whole and, at another resolution, the same shape.
std::array<Mesh, 2> shape_of(const PartScene& s) {
  switch (s.shape) {
    case 0:
      return {bust(s.seed, 30), bust(s.seed, 24)};
    case 1:
      return {animal(32), animal(26)};
    case 2:
      return {man(32), man(26)};
    default:
      return {noisy_sphere(Vec3::Zero(), 1, 4, 0.3, s.seed), noisy_sphere(Vec3::Zero(), 1, 3, 0.3, s.seed)};
  }
}

std::string broken(const PartScene& scene, SceneTally& tally) {
  Random random(scene.seed + 1);
  const auto [whole, other] = shape_of(scene);
  const Mesh& source = scene.same_mesh ? whole : other;
  const double size = whole.bounds().diagonal().norm();
  Mesh part = mesh::take_faces(source, share_along(source, random.direction(), scene.share));
  Eigen::Affine3d away = Eigen::Affine3d::Identity();
  away.linear() = scene.scale * random.rotation();
  if (scene.mirror) away.linear() *= Vec3(-1, 1, 1).asDiagonal();
  away.translation() = size * random.uniform(0, 3) * random.direction();
  Mesh moving = mesh::transformed(part, away);
  for (Vec3& p : moving.vertices) p += scene.scale * size * scene.noise * random.direction();
  align::AlignOptions options;
  options.allow_scale = scene.scale != 1;
  options.allow_mirror = scene.mirror;
  options.less_overlap = true;
  Progress silent;
  const align::AlignResult r = align::align_part_in_whole(moving, {}, whole, {}, options, silent);
  const Eigen::Matrix3d linear = r.matrix.topLeftCorner<3, 3>();
  const double scale = std::cbrt(std::abs(linear.determinant()));
  if (!r.matrix.allFinite()) return "a matrix that is not finite";
  if (!(linear.transpose() * linear).isApprox(scale * scale * Eigen::Matrix3d::Identity(), 1e-9))
    return "a matrix that is no similarity";
  if (!options.allow_scale && std::abs(scale - 1) > 1e-9) return "a scale that was not asked for";
  if (!options.allow_mirror && linear.determinant() < 0) return "a mirror that was not asked for";
  if (!(r.rms_after <= r.rms_before * (1 + 1e-9))) return "placed farther away than before";
  double sum = 0;
  for (const Vec3& p : part.vertices) sum += (Eigen::Affine3d(r.matrix) * (away * p) - p).squaredNorm();
  const double off = std::sqrt(sum / part.vertex_count()) / size;
  tally.flawless += off < 0.02;
  tally.doubted += !r.doubts.empty();
  if (off > 0.05 && r.doubts.empty())
    return std::to_string(off) + " sizes from its place, and nothing is said (inlier share " +
           std::to_string(r.inlier_share) + ")";
  return {};
}

TEST(RandomScenes, Align) {
  const SceneTally tally = check_scenes(
      16, part_scene, [](const PartScene& s, SceneTally& t) { return broken(s, t); },
      [](const PartScene& s) { return simpler(s); });
  EXPECT_GE(tally.share(tally.flawless), 0.9);
}

}  // namespace
}  // namespace parts::test
