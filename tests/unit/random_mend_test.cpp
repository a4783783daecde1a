// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "mend_support.h"
#include "parts/mend/small_holes.h"
#include "parts/mesh/result_check.h"
#include "unit/random_support.h"

namespace parts::test {
namespace {

/// A bean of which pieces are gone or damaged, and a class of other beans.
struct MendScene {
  unsigned seed = 0;
  bool fill = true;
  int places = 1, models = 2;
  double radius = 0.4, scale = 1, away = 0;  ///< of a place; of the scan; from the origin, in its sizes
  double noise = 0;                          ///< of the scan, in its sizes
  bool colors = false, texture = false, soup = false;

  std::string describe() const {
    return std::to_string(places) + (fill ? " holes" : " flaws") + " of radius " + std::to_string(radius) + ", " +
           std::to_string(models) + " models, scale " + std::to_string(scale) + ", away " + std::to_string(away) +
           ", noise " + std::to_string(noise) + (colors ? ", colours" : "") + (texture ? ", a texture" : "") +
           (soup ? ", a soup" : "");
  }
};

MendScene mend_scene(unsigned seed, bool fill) {
  Random random(seed);
  MendScene s;
  s.seed = seed, s.fill = fill;
  s.places = 1 + random.below(3), s.models = 1 + random.below(3);
  s.radius = random.uniform(0.15, 0.6);
  s.scale = random.below(2) ? std::pow(10, random.uniform(-3, 3)) : 1;
  s.away = random.below(3) ? 0 : random.uniform(1, 100);
  s.noise = random.below(3) ? 0 : random.uniform(0, 0.005);
  s.colors = random.below(2), s.texture = random.below(2), s.soup = random.below(4) == 0;
  return s;
}

std::vector<MendScene> simpler(const MendScene& scene) {
  std::vector<MendScene> all;
  const auto add = [&](bool wanted, auto change) {
    MendScene s = scene;
    change(s);
    if (wanted) all.push_back(s);
  };
  add(scene.places > 1, [](auto& s) { --s.places; });
  add(scene.models > 1, [](auto& s) { --s.models; });
  add(scene.scale != 1, [](auto& s) { s.scale = 1; });
  add(scene.away > 0, [](auto& s) { s.away = 0; });
  add(scene.noise > 0, [](auto& s) { s.noise = 0; });
  add(scene.colors, [](auto& s) { s.colors = false; });
  add(scene.texture, [](auto& s) { s.texture = false; });
  add(scene.soup, [](auto& s) { s.soup = false; });
  return all;
}

struct MendInput {
  Mesh whole, scan;
  std::vector<Mesh> models;
};

MendInput input_of(const MendScene& s) {
  Random random(s.seed + 1);
  MendInput in;
  in.whole = bean(s.seed, 4);
  for (int m = 0; m < s.models; ++m) in.models.push_back(bean(s.seed + 1000 * unsigned(m + 1), 4));
  std::vector<Vec3> centers;
  for (int n = 0; n < s.places; ++n)
    centers.push_back(in.whole.vertices[std::size_t(random.below(in.whole.vertex_count()))]);
  const std::vector<char> gone = faces_where(in.whole, [&](const Vec3& c) {
    return std::any_of(centers.begin(), centers.end(), [&](const Vec3& p) { return (c - p).norm() < s.radius; });
  });
  Eigen::Affine3d place = Eigen::Affine3d::Identity();
  place.linear() = s.scale * random.rotation();
  place.translation() = s.scale * 2 * s.away * random.direction();
  in.whole = moved(in.whole, place);
  in.scan = in.whole;
  for (Vec3& p : in.scan.vertices) p += s.scale * 2 * s.noise * random.direction();
  in.scan = mesh::in_single_precision(in.scan);
  dress(in.scan, s.colors, s.texture);
  if (s.fill) {
    std::vector<char> stays;
    for (const char g : gone) stays.push_back(!g);
    in.scan = mesh::take_faces(in.scan, stays);
  } else {
    for (int f = 0; f < in.scan.face_count(); ++f)
      if (gone[f]) in.scan.vertices[in.scan.faces[f][0]] += s.scale * 0.1 * random.direction();
    in.scan = mesh::in_single_precision(in.scan);
    in.scan.face_selected = gone;
  }
  if (s.soup) {
    Mesh soup = in.scan;
    soup.vertices.clear(), soup.vertex_color.clear();
    for (int f = 0; f < in.scan.face_count(); ++f)
      for (int k = 0; k < 3; ++k) {
        soup.vertices.push_back(in.scan.corner(f, k));
        if (s.colors) soup.vertex_color.push_back(in.scan.vertex_color[in.scan.faces[f][k]]);
        soup.faces[f][k] = 3 * f + k;
      }
    in.scan = soup;
  }
  return in;
}

/// Faces change in the regions only, which are the flaws and a margin of 0.35 of their half diagonals.
std::string changed_elsewhere(const Mesh& scan, const mend::RegionOptions& options, const Mesh& result) {
  const mend::Scan ready(scan);
  Progress silent;
  const std::vector<mend::Region> regions = mend::flaw_regions(ready, options, silent);
  for (const mend::Region& r : regions) {
    Box flaw;
    for (const int f : r.flaw) flaw.extend(ready.mesh().face_box(f));
    const Vec3 margin = Vec3::Constant(0.36 * flaw.diagonal().norm() / 2);
    if (!Box(flaw.min() - margin, flaw.max() + margin).contains(r.box)) return "a region larger than flaw and margin";
  }
  const std::set<FaceKey> kept = face_keys(result);
  for (int f = 0; f < scan.face_count(); ++f)
    if (!kept.count(face_key(scan, f)) &&
        std::none_of(regions.begin(), regions.end(), [&](const auto& r) { return r.box.intersects(scan.face_box(f)); }))
      return "a face has changed outside of the regions";
  return {};
}

std::string broken(const MendScene& scene, SceneTally& tally) {
  const MendInput in = input_of(scene);
  const Database database(in.models);
  mend::MendOptions options;
  options.fill = scene.fill;
  if (scene.fill) options.region = around_holes();
  mend::Mended m;
  try {
    Progress silent;
    m = mend::mend_scan(in.scan, &*database, options, silent);
  } catch (const UserError&) {
    ++tally.refused;
    return {};
  }
  mesh::check_arrays(m.mesh);
  if (const std::string worse = worse_than({in.scan}, m.mesh); !worse.empty()) return worse;
  ++tally.flawless;
  int replaced = m.crumbs;
  for (const mend::RegionReport& r : m.regions) replaced += r.restored.faces_replaced;
  const int lost = missing(in.scan, m.mesh, [](int) { return true; });
  if (lost > replaced) return std::to_string(lost) + " faces lost, " + std::to_string(replaced) + " reported";
  if (scene.fill && mesh::measure_surface(m.mesh).borders != m.count(mend::RegionReport::End::Left))
    return "other borders than are said to be left";
  if (!scene.fill)
    if (const std::string what = changed_elsewhere(in.scan, options.region, m.mesh); !what.empty()) return what;
  if (const std::string what = dressed_otherwise(in.scan, m.mesh); !what.empty()) return what;
  if (scene.colors && m.mesh.vertex_color.empty()) return "the colours are gone";
  const double size = in.whole.bounds().diagonal().norm();
  const spatial::ClosestFace truth(in.whole);
  double farthest = 0;
  for (const Vec3& p : m.mesh.vertices) farthest = std::max(farthest, truth(p).distance);
  if (farthest > (scene.fill ? 0.1 : 0.12) * size) return "a vertex " + std::to_string(farthest / size) + " sizes off";
  return {};
}

/// A crumpled ball without the faces around some of its vertices.
struct PinholeScene {
  unsigned seed = 0;
  int pinholes = 1;
  double crumpled = 0.9;

  std::string describe() const {
    return std::to_string(pinholes) + " pinholes, crumpled by " + std::to_string(crumpled);
  }
};

std::string broken_pinholes(const PinholeScene& s, SceneTally& tally) {
  Random random(s.seed);
  Mesh ball = noisy_sphere(Vec3::Zero(), 1, 3, s.crumpled, s.seed);
  for (Vec3& p : ball.vertices) p += s.crumpled * 0.15 * random.direction();
  std::vector<char> gone(ball.vertices.size(), 0);
  for (int n = 0; n < s.pinholes; ++n) gone[std::size_t(random.below(ball.vertex_count()))] = 1;
  std::vector<char> stays;
  for (const Triangle& f : ball.faces) stays.push_back(!gone[f[0]] && !gone[f[1]] && !gone[f[2]]);
  const mend::Scan scan(mesh::take_faces(ball, stays));
  std::vector<mesh::Loop> small;
  for (const mesh::Loop& rim : scan.rims())
    if (mend::is_small(rim)) small.push_back(rim);
  const mend::SmallHoles done = mend::close_small(scan, small);
  const int closed = int(std::count(done.closed.begin(), done.closed.end(), 1));
  tally.flawless += closed == int(small.size());
  if (done.scan.rims().size() + closed != scan.rims().size()) return "other rims than are said to be closed";
  mesh::ResultRules rules;
  rules.may_part = true;
  return worse_than({scan.mesh()}, done.scan.mesh(), rules);
}

TEST(RandomScenes, PinholesAreClosedWithoutCrossings) {
  const auto scene = [](unsigned seed) {
    Random random(seed);
    return PinholeScene{seed, 1 + random.below(12), random.uniform(0.1, 1)};
  };
  const SceneTally tally = check_scenes(200, scene, broken_pinholes, [](const PinholeScene& s) {
    std::vector<PinholeScene> all;
    if (s.pinholes > 1) all.push_back({s.seed, s.pinholes - 1, s.crumpled});
    return all;
  });
  EXPECT_GE(tally.share(tally.flawless), 0.5);
}

TEST(RandomScenes, FillHole) {
  const SceneTally tally = check_scenes(
      16, [](unsigned seed) { return mend_scene(seed, true); }, broken, simpler);
  EXPECT_LE(tally.refused, tally.scenes / 4);
}

TEST(RandomScenes, Restore) {
  const SceneTally tally = check_scenes(
      16, [](unsigned seed) { return mend_scene(seed, false); }, broken, simpler);
  EXPECT_LE(tally.refused, tally.scenes / 4);
}

}  // namespace
}  // namespace parts::test
