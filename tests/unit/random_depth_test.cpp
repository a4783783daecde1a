// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>

#include "parts/render/depth_mesh.h"
#include "unit/random_support.h"

namespace parts::test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

struct DepthScene {
  unsigned seed = 0;
  int width = 0, height = 0, bumps = 0;
  bool back = false;
  double focal = 0, jump = 0, noise = 0, missing = 0;

  std::string describe() const {
    return std::to_string(width) + " x " + std::to_string(height) + " pixels, " + std::to_string(bumps) + " bumps" +
           (back ? ", a back" : "") + ", focal " + std::to_string(focal) + ", jump " + std::to_string(jump) +
           ", noise " + std::to_string(noise) + ", missing " + std::to_string(missing);
  }
};

DepthScene depth_scene(unsigned seed) {
  Random random(seed);
  DepthScene s;
  s.seed = seed;
  s.width = 2 + random.below(45), s.height = 2 + random.below(45);
  s.bumps = random.below(6);
  s.back = random.below(2);
  s.focal = random.below(2) ? random.uniform(10, 80) : 0;
  s.jump = random.below(2) ? random.uniform(0.1, 5) : 0;
  s.noise = random.below(2) ? std::pow(10, random.uniform(-6, 0.5)) : 0;
  s.missing = random.below(2) ? random.uniform(0, 0.5) : 0;
  return s;
}

std::vector<DepthScene> simpler(const DepthScene& scene) {
  std::vector<DepthScene> all;
  const auto add = [&](bool wanted, auto change) {
    DepthScene s = scene;
    change(s);
    if (wanted) all.push_back(s);
  };
  add(scene.width > 3, [](auto& s) { s.width /= 2; });
  add(scene.height > 3, [](auto& s) { s.height /= 2; });
  add(scene.bumps > 0, [](auto& s) { --s.bumps; });
  add(scene.back, [](auto& s) { s.back = false; });
  add(scene.focal > 0, [](auto& s) { s.focal = 0; });
  add(scene.jump > 0, [](auto& s) { s.jump = 0; });
  add(scene.noise > 0, [](auto& s) { s.noise = 0; });
  add(scene.missing > 0, [](auto& s) { s.missing = 0; });
  return all;
}

/// Front and back: a slope, discs at other depths, noise, pixels without a depth.
std::array<cv::Mat, 2> rasters(const DepthScene& s) {
  Random random(s.seed + 1);
  cv::Mat front(s.height, s.width, CV_32F), back = front.clone();
  const double dx = random.uniform(-0.2, 0.2), dy = random.uniform(-0.2, 0.2), thick = random.uniform(-1, 6);
  for (int v = 0; v < s.height; ++v)
    for (int u = 0; u < s.width; ++u) front.at<float>(v, u) = float(40 + dx * u + dy * v);
  for (int n = 0; n < s.bumps; ++n) {
    const double x = random.uniform(0, s.width), y = random.uniform(0, s.height), r = random.uniform(1, s.width);
    const double step = random.uniform(-10, 10);
    const bool hole = random.below(3) == 0, round = random.below(2);
    for (int v = 0; v < s.height; ++v)
      for (int u = 0; u < s.width; ++u) {
        const double d = std::hypot(u - x, v - y) / r;
        if (d >= 1) continue;
        front.at<float>(v, u) = hole ? kNaN : front.at<float>(v, u) + float(round ? step * std::sqrt(1 - d * d) : step);
      }
  }
  for (int v = 0; v < s.height; ++v)
    for (int u = 0; u < s.width; ++u) {
      float& z = front.at<float>(v, u);
      z += float(s.noise * random.uniform(-1, 1));
      back.at<float>(v, u) = z + float(thick + s.noise * random.uniform(-1, 1));
      if (random.uniform(0, 1) < s.missing) z = kNaN;
      if (random.uniform(0, 1) < s.missing) back.at<float>(v, u) = kNaN;
    }
  return {front, back};
}

/// A front surface is the raster's: each vertex at its pixel, nothing across a jump, the image on it.
std::string unlike_the_raster(const render::DepthMesh& out, const cv::Mat& front, const render::Camera& camera) {
  const auto pixel = [&](int v) { return Vec3(camera.project(out.mesh.vertices[v]) - Vec3(0.5, 0.5, 0)); };
  for (int f = 0; f < out.mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = pixel(out.mesh.faces[f][k]), b = pixel(out.mesh.faces[f][(k + 1) % 3]);
      const int u = int(std::lround(a.x())), v = int(std::lround(a.y()));
      if (u < 0 || v < 0 || u >= front.cols || v >= front.rows || std::hypot(a.x() - u, a.y() - v) > 1e-6)
        return "a vertex beside the pixels";
      if (!(std::abs(front.at<float>(v, u) - a.z()) <= 1e-5 * a.z())) return "a vertex of another depth";
      const bool beside = std::abs(a.x() - b.x()) + std::abs(a.y() - b.y()) < 1.5;
      if (beside && std::abs(a.z() - b.z()) > out.max_jump * (1 + 1e-5)) return "a face across a jump";
      const Eigen::Vector2f at((float(u) + 0.5f) / float(front.cols), 1 - (float(v) + 0.5f) / float(front.rows));
      if (!((out.mesh.wedges[f].uv[k] - at).norm() < 1e-5)) return "the image in another place";
    }
  return {};
}

/// Whether a solid stays within the depths of its pixels.
std::string beyond_the_rasters(const render::DepthMesh& out, const cv::Mat& front, const cv::Mat& back,
                               const render::Camera& camera) {
  double nearest = 1e30, farthest = 0;
  for (const cv::Mat* raster : {&front, &back})
    for (auto z = raster->begin<float>(); z != raster->end<float>(); ++z)
      if (*z > 0) nearest = std::min(nearest, double(*z)), farthest = std::max(farthest, double(*z));
  const double pixel = camera.focal > 0 ? farthest / camera.focal : 1 / camera.scale;
  for (const Vec3& p : out.mesh.vertices) {
    const Vec3 at = camera.project(p) - Vec3(0.5, 0.5, 0);
    if (at.x() < -1e-6 || at.y() < -1e-6 || at.x() > front.cols - 1 + 1e-6 || at.y() > front.rows - 1 + 1e-6)
      return "a vertex beside the image";
    if (at.z() < nearest * (1 - 1e-6) || at.z() > farthest * (1 + 1e-6) + pixel) return "a vertex beyond all depths";
  }
  return {};
}

std::string broken(const DepthScene& scene, SceneTally& tally) {
  const auto [front, back] = rasters(scene);
  const render::Camera camera = render::raster_camera(front.size(), 1, scene.focal);
  render::DepthMesh out;
  try {
    Progress silent;
    out = render::depth_to_mesh(front, scene.back ? back : cv::Mat(), camera, {scene.jump}, silent);
  } catch (const UserError&) {
    ++tally.refused;
    const bool plain = scene.bumps == 0 && scene.jump == 0 && scene.noise == 0 && scene.missing == 0;
    return plain ? "a plain slope is refused" : "";
  }
  out.mesh.textures = {"image.png"};
  mesh::check_arrays(out.mesh);
  const mesh::MeshCheck c = mesh::check(out.mesh);
  if (c.faces == 0 || c.unused_vertices + c.degenerate_faces + c.nonfinite_vertices > 0) return mesh::to_string(c);
  if (!c.manifold() || !c.oriented()) return mesh::to_string(c);
  if (scene.back && !c.closed()) return "open\n" + mesh::to_string(c);
  mesh::ResultRules rules;
  rules.may_part = true, rules.may_open = !scene.back;
  if (const std::string worse = worse_than({}, out.mesh, rules); !worse.empty()) return worse;
  ++tally.flawless;
  if (scene.back && !(volume_of(out.mesh) > 0)) return "its inside out";
  return scene.back ? beyond_the_rasters(out, front, back, camera) : unlike_the_raster(out, front, camera);
}

TEST(RandomScenes, DepthToMesh) {
  const SceneTally tally = check_scenes(400, depth_scene, broken, simpler);
  EXPECT_LE(tally.refused, tally.scenes * 15 / 100);  // specks, all torn
}

}  // namespace
}  // namespace parts::test
