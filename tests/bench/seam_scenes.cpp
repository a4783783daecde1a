// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/seam_scenes.h"

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "parts/compose/constraint.h"
#include "parts/io/mesh_io.h"
#include "parts/mesh/attributes.h"

namespace parts::bench {
namespace {

constexpr double kAll = 9;  // beyond every model

Mesh placed(const Mesh& mesh, const Eigen::Matrix3d& turn, const Vec3& shift) {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() = turn, map.translation() = shift;
  return mesh::transformed(mesh, map);
}

/// libcgal-demo's man stands along z: here along y.
Mesh upright(const Mesh& mesh, const Vec3& shift = Vec3::Zero()) {
  Eigen::Matrix3d turn;
  turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return placed(mesh, turn, shift);
}

Mesh scaled(const Mesh& mesh, double by, const Vec3& shift) {
  return placed(mesh, by * Eigen::Matrix3d::Identity(), shift);
}

Mesh turned(const Mesh& mesh, const Vec3& about, const Vec3& axis, double degrees) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(degrees * M_PI / 180, axis.normalized()).matrix();
  return placed(mesh, turn, about - turn * about);
}

cut::Part part(Mesh mesh, const Vec3& low, const Vec3& high) {
  std::vector<char> keep =
      compose::constrained_faces(mesh, compose::ConstraintBy::Box, low, high, "a model of the benchmark");
  return {std::move(mesh), std::move(keep)};
}

Box above(int axis, double from) {
  Box box(Vec3::Constant(-kAll), Vec3::Constant(kAll));
  box.min()[axis] = from;
  return box;
}
Box below(int axis, double to) {
  Box box(Vec3::Constant(-kAll), Vec3::Constant(kAll));
  box.max()[axis] = to;
  return box;
}
cut::Part part(Mesh mesh, const Box& box) { return part(std::move(mesh), box.min(), box.max()); }

/// The result of composing two parts with the default cut: for scenes of several steps.
Mesh composed(const cut::Part& a, const cut::Part& b) {
  Progress silent;
  return compose::compose(a, b, {}, silent).composed;
}

void add_animals(std::vector<Scene>& scenes) {
  const Mesh cow = cgal_mesh("cow.off"), dino = scaled(cgal_mesh("triceratops.off"), 0.06, {0.03, 0, 0});
  scenes.push_back({"cow's head on triceratops", part(cow, above(0, 0.38)), part(dino, below(0, 0))});
  scenes.push_back({"triceratops' head on cow", part(dino, above(0, 0.38)), part(cow, below(0, 0))});
  // Cerberus: two more heads, turned about the shoulders.
  const Vec3 shoulders(0.12, 0, 0);
  const auto faces = [](const Mesh& mesh, const auto& test) {
    std::vector<char> keep;
    for (int f = 0; f < mesh.face_count(); ++f) {
      bool any = false;
      for (int k = 0; k < 3; ++k) any |= test(mesh.corner(f, k));
      keep.push_back(any);
    }
    return keep;
  };
  const Mesh left = turned(cow, shoulders, Vec3::UnitY(), 38), right = turned(cow, shoulders, Vec3::UnitY(), -38);
  const cut::Part first{cow, faces(cow, [](const Vec3& p) { return p.y() < -0.1 || p.x() > 0.4; })};
  const cut::Part second{left, faces(left, [](const Vec3& p) { return p.x() > 0.2 && p.z() < -0.16; })};
  scenes.push_back({"cow's second head", first, second});
  const Mesh two = composed(first, second);
  scenes.push_back({"cow's third head",
                    {two, faces(two,
                                [](const Vec3& p) {
                                  return p.y() < -0.1 || (p.x() > 0.4 && std::abs(p.z()) < 0.1) ||
                                         (p.x() > 0.2 && p.z() < -0.16);
                                })},
                    {right, faces(right, [](const Vec3& p) { return p.x() > 0.2 && p.z() > 0.16; })}});
}

void add_centaur(std::vector<Scene>& scenes) {
  const Mesh man = cgal_mesh("man.off"), camel = cgal_mesh("camel.off");
  Mesh chest = ball(30, [](const Vec3&) { return 0.1; });
  for (Vec3& p : chest.vertices) p = Vec3(p.x(), 1.2 * p.y() + 0.12, p.z() + 0.17);
  const cut::Part a = part(chest, above(2, 0.26)), b = part(camel, below(1, -0.3));
  scenes.push_back({"chest on camel", a, b});
  const Mesh body = composed(a, b);
  scenes.push_back({"man on camel", part(upright(man, {0, 0.18, 0.07}), above(1, 0.58)), part(body, below(1, -0.3))});
}

void add_shapes(std::vector<Scene>& scenes) {
  for (Scene s : {two_spheres(5000), two_tubes(5000), two_tori(5000), two_creatures(5000)}) scenes.push_back(s);
}

}  // namespace

Mesh cgal_mesh(const std::string& file) {
  const std::string path = std::string(SOURCE_DIR) + "/build/models/" + file;
  if (!std::filesystem::exists(path)) {
    const std::string command = std::string(SOURCE_DIR) + "/tools/cgal-mesh " + file + " >/dev/null";
    if (std::system(command.c_str()) != 0) throw std::runtime_error("no mesh " + file + " of libcgal-demo");
  }
  return io::read_mesh(path);
}

std::vector<char> faces_in(const Mesh& mesh, const Box& box) {
  return compose::constrained_faces(mesh, compose::ConstraintBy::Box, box.min(), box.max(), "a model");
}

std::vector<Scene> seam_scenes() {
  std::vector<Scene> scenes;
  add_animals(scenes);
  add_centaur(scenes);
  add_shapes(scenes);
  return scenes;
}

}  // namespace parts::bench
