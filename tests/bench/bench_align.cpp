// SPDX-License-Identifier: GPL-3.0-or-later
// How often align_part_in_whole finds the placement, from random starts, and
// how long it takes. bench_align [RUNS]: so many random starts a line.

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <random>

#include "bench/measure.h"
#include "bench/scenes.h"
#include "parts/align/align.h"
#include "parts/io/mesh_io.h"
#include "support/shapes.h"

using namespace parts;
using namespace parts::bench;

namespace {

using test::Random;

struct Kind {
  std::string name;
  std::vector<Mesh> meshes;
  bool same_vertices = false;  ///< index for index: the truth between two of them is known
};

struct Task {
  const char* name;
  double moving_share = 1, fixed_share = 1;  ///< of the area that is emphasised
  double overlap = 0.9;
  bool scale = false, mirror = false, noise = false, other = false;
};
const Task kTasks[] = {
    {"same shape"},
    {"noise of 0.5 %", 1, 1, 0.9, false, false, true},
    {"scaled", 1, 1, 0.9, true},
    {"mirrored", 1, 1, 0.9, false, true},
    {"60 % in the whole", 0.6},
    {"30 % in the whole", 0.3},
    {"15 % in the whole", 0.15},
    {"60 %, scaled", 0.6, 1, 0.9, true},
    {"whole on 60 %", 1, 0.6, 0.55},
    {"75 % on 75 %", 0.75, 0.75, 0.6},
    {"another one", 1, 1, 0.9, false, false, false, true},
    {"another one, scaled", 1, 1, 0.9, true, false, false, true},
};

/// Faces on one side of a random plane that leaves that share of the area.
std::vector<char> piece(const Mesh& mesh, double share, Random& random) {
  if (share == 1) return {};
  return test::share_along(mesh, random.direction(), share);
}

struct Tried {
  bool found = false;
  double degrees = 0;
  Times times;
  double gap = 0;  ///< longest between two words of progress, seconds
};

Tried try_once(const Kind& kind, const Task& task, Random& random) {
  const int a = random.below(int(kind.meshes.size()));
  int b = a;
  while (task.other && b == a) b = random.below(int(kind.meshes.size()));
  const Mesh& fixed = kind.meshes[b];
  const double size = kind.meshes[a].bounds().diagonal().norm();
  Mesh moving = kind.meshes[a];
  const std::vector<char> moving_part = piece(moving, task.moving_share, random);
  const std::vector<char> fixed_part = piece(fixed, task.fixed_share, random);

  Eigen::Affine3d away = Eigen::Affine3d::Identity();
  away.linear() = random.rotation() * (task.scale ? std::exp(random.uniform(-1.5, 1.5)) : 1);
  if (task.mirror) away.linear().col(0) *= -1;
  away.translation() = size * random.uniform(0, 3) * random.direction();
  for (Vec3& v : moving.vertices) {
    if (task.noise) v += random.uniform(0, 0.005) * size * random.direction();
    v = away * v;
  }

  align::AlignOptions options;
  options.allow_scale = task.scale, options.allow_mirror = task.mirror, options.overlap = task.overlap;
  Tried tried;
  Stopwatch last;
  Progress progress([&](int, const char*) {
    tried.gap = std::max(tried.gap, last.wall());
    last = Stopwatch();
    return true;
  });
  const Stopwatch watch;
  const align::AlignResult r = align::align_part_in_whole(moving, moving_part, fixed, fixed_part, options, progress);
  tried.times = {watch.wall(), watch.cpu()};

  Eigen::Affine3d left = Eigen::Affine3d(r.matrix) * away;  // what is left to the truth
  if (task.other && kind.same_vertices) {
    Eigen::Matrix3Xd from(3, fixed.vertex_count()), to = from;
    for (int v = 0; v < fixed.vertex_count(); ++v)
      from.col(v) = kind.meshes[a].vertices[v], to.col(v) = fixed.vertices[v];
    left = left * Eigen::Affine3d(Eigen::umeyama(from, to, false)).inverse();
  }
  const Eigen::Matrix3d rotation = left.linear() / std::cbrt(left.linear().determinant());
  tried.degrees = left.linear().determinant() > 0 ? Eigen::AngleAxisd(rotation).angle() * 180 / M_PI : 180;
  double sum = 0;
  for (const Vec3& v : kind.meshes[a].vertices) sum += (left * v - v).squaredNorm();
  const double off = std::sqrt(sum / kind.meshes[a].vertex_count()) / size;
  tried.found = task.other ? tried.degrees < 10 : off < 0.01;
  return tried;
}

std::vector<Kind> kinds() {
  Kind balls{"Bumpy balls", {}, false}, creatures{"Creatures", {}, false};
  for (int seed = 0; seed < 6; ++seed) {
    Random random(1);
    for (int k = 0; k < 40 * seed; ++k) random.below(2);
    std::vector<std::pair<Vec3, double>> bumps;
    for (int k = 0; k < 7; ++k) bumps.emplace_back(random.direction(), random.uniform(-0.3, 0.5));
    balls.meshes.push_back(ball(40, [bumps](const Vec3& d) {
      double r = 1;
      for (const auto& [at, height] : bumps) r += height * std::exp(-4 * (d - at).squaredNorm());
      return r;
    }));
  }
  for (int faces : {12000, 16000, 20000}) creatures.meshes.push_back(two_creatures(faces).a.mesh);
  std::vector<Kind> all{std::move(balls), std::move(creatures)};
  const std::filesystem::path data = PARTS_DATA;
  if (data.empty() || !std::filesystem::exists(data))
    std::cout << "No PARTS_DATA: heads, bodies and hands are left out.\n";
  else
    for (const char* name : {"heads", "head_shapes", "bodies", "hands"}) {
      Kind kind{name, {}, std::string(name) != "bodies"};
      std::vector<std::filesystem::path> files;
      for (const auto& e : std::filesystem::directory_iterator(data / name))
        if (e.path().extension() == ".obj" || e.path().extension() == ".ply") files.push_back(e.path());
      std::sort(files.begin(), files.end());
      for (std::size_t i = 0; i < files.size(); ++i)
        if (kind.name != "hands" || i % 2 == 0) kind.meshes.push_back(io::read_mesh(files[i].string()));  // left hands
      all.push_back(std::move(kind));
    }
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 10;
  for (const Kind& kind : kinds()) {
    Table table(kind.name + ", " + bench::count(kind.meshes[0].face_count()) + " faces: placements found from " +
                    std::to_string(runs) + " random starts",
                {"Task", "Found", "Degrees off", "Seconds", "CPU seconds", "Longest silence"});
    int all_found = 0, all_runs = 0;
    for (const Task& task : kTasks) {
      // Bodies have other poses, and the generated shapes other forms: no rigid motion is right.
      if (task.other && !kind.same_vertices) continue;
      Random random(1);
      int found = 0;
      Times sum;
      double gap = 0;
      std::vector<double> degrees;
      for (int i = 0; i < runs; ++i) {
        const Tried t = try_once(kind, task, random);
        found += t.found;
        degrees.push_back(t.degrees);
        sum.wall += t.times.wall, sum.cpu += t.times.cpu;
        gap = std::max(gap, t.gap);
      }
      all_found += found, all_runs += runs;
      std::nth_element(degrees.begin(), degrees.begin() + runs / 2, degrees.end());
      table.row({task.name, std::to_string(found) + " / " + std::to_string(runs), text(degrees[runs / 2], 2),
                 text(sum.wall / runs), text(sum.cpu / runs), text(gap, 2)});
    }
    figure("align: " + kind.name + ", found", Better::Higher, double(all_found) / all_runs);
    table.note("Found: within 1 % of the size; another one: turned less than 10°. Degrees: median; seconds: mean.");
  }
}
