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

/// Not in any demo.
void add_strangers(std::vector<Scene>& scenes) {
  const Mesh man = upright(cgal_mesh("man.off")), homer = cgal_mesh("homer.off"),
             bear = scaled(cgal_mesh("bear.off"), 0.3, {0, 0.245, 0});
  scenes.push_back({"bear's head on man", part(bear, above(1, 0.43)), part(man, below(1, 0.2))});
  scenes.push_back({"Homer's head on man", part(homer, above(1, 0.3)), part(man, below(1, 0.1))});
  scenes.push_back({"man's head on Homer", part(man, above(1, 0.42)), part(homer, below(1, -0.1))});
}

void add_optional(std::vector<Scene>& scenes) {
  const std::string data = PARTS_DATA;
  if (data.empty() || !std::filesystem::exists(data + "/heads")) {
    std::cout << "No folder of optional models (PARTS_DATA): faces and hands are left out.\n";
    return;
  }
  const Mesh face = io::read_mesh(data + "/heads/head_000.obj"), head = io::read_mesh(data + "/heads/head_001.obj");
  scenes.push_back(
      {"face on another head", part(face, {-0.35, -0.6, 0.1}, {0.35, 0.1, kAll}), part(head, below(2, -0.8))});
  const Mesh fist = io::read_mesh(data + "/hands/hand_000.obj"), hand = io::read_mesh(data + "/hands/hand_002.obj");
  scenes.push_back({"hand in another pose", part(fist, above(1, 1.0)), part(hand, below(1, -0.2))});
}

/// Two overlapping halves of a surface, as two scans give them.
void add_half_scans(std::vector<Scene>& scenes) {
  const auto half = [](const Vec3& from, double waviness) {
    Mesh whole = ball(20, [&](const Vec3& d) { return 1 + 0.1 * std::sin(5 * d[0]) + waviness * std::sin(31 * d[1]); });
    std::vector<char> flags;
    for (int f = 0; f < whole.face_count(); ++f) flags.push_back(whole.center(f).dot(from) > -0.2);
    return mesh::take_faces(whole, flags);
  };
  const Mesh front = half(Vec3::UnitZ(), 0.002), back = half(-Vec3::UnitZ(), -0.002);
  scenes.push_back({"half scans", part(front, above(2, 0.6)), part(back, below(2, -0.6))});
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

std::vector<Bend> bends() {
  std::vector<Bend> all;
  const auto add = [&](const std::string& name, const Mesh& mesh, const Box& fixed, const Box& moving,
                       const Vec3& pivot, const Vec3& axis, double angle) {
    compose::RigidPose pose;
    pose.pivot = pivot, pose.axis = axis, pose.angle = angle;
    all.push_back({name, mesh, part(mesh, fixed).keep, part(mesh, moving).keep, pose});
  };
  const Mesh man = upright(cgal_mesh("man.off")), cow = cgal_mesh("cow.off");
  const Box hand(Vec3(0.11, -0.06, 0), Vec3(0.2, 0.02, 0.2));
  for (double angle : {-25., -50., -90.})
    add("man's arm " + std::to_string(int(angle)), man, above(1, 0.35), hand, {0.13, 0.14, 0.055}, Vec3::UnitX(),
        angle);
  add("man's head 40", man, below(1, 0.2), above(1, 0.42), {0, 0.36, 0}, Vec3::UnitY(), 40);
  for (double angle : {30., 60.})
    add("cow's head " + std::to_string(int(angle)), cow, below(0, 0), above(0, 0.38), {0.25, 0.12, 0}, Vec3::UnitY(),
        angle);
  add("elephant's trunk 45", cgal_mesh("elephant.off"), below(1, 0), above(1, 0.4), {0.16, 0.25, 0}, Vec3::UnitZ(), 45);
  return all;
}

std::vector<Scene> seam_scenes() {
  std::vector<Scene> scenes;
  add_animals(scenes);
  add_centaur(scenes);
  add_strangers(scenes);
  add_optional(scenes);
  add_half_scans(scenes);
  add_shapes(scenes);
  return scenes;
}

}  // namespace parts::bench
