// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <random>
#include <vector>

#include "parts/mesh/mesh.h"

/// Shapes for tests and benchmarks: closed, oriented outwards, without
/// self-intersections unless a line says otherwise.
namespace parts::test {

Mesh box(const Vec3& min, const Vec3& max, int divisions = 1);
/// An icosahedron divided `subdivisions` times: 20 * 4^subdivisions faces.
Mesh sphere(const Vec3& center = Vec3::Zero(), double radius = 1, int subdivisions = 3);
/// A sphere whose radius varies smoothly by up to +- amplitude * radius.
Mesh noisy_sphere(const Vec3& center, double radius, int subdivisions, double amplitude, unsigned seed);
/// Around the z axis: 2 * around * across faces.
Mesh torus(const Vec3& center = Vec3::Zero(), double radius = 1, double tube = 0.35, int around = 48, int across = 24);

struct Ball {
  Vec3 center;
  double radius;
};
/// A tube with round ends along a path of balls.
Mesh tube(const std::vector<Ball>& path, int around = 24);
/// A profile (radius, height) turned around the z axis; it starts and ends on
/// the axis and runs anticlockwise (up outside).
Mesh lathe(const std::vector<Eigen::Vector2d>& profile, int around = 48);

/// The surface field = 0 (negative inside) by marching tetrahedra, then relaxed
/// to even triangles; the field must be positive on the box's sides.
/// @param cells  along the longest side
Mesh isosurface(const std::function<double(const Vec3&)>& field, const Box& box, int cells);
/// Limbs melted into one surface: round cones between two balls each.
struct Limb {
  Ball from, to;
};
Mesh blend(const std::vector<Limb>& limbs, double softness, int cells);

/// Creatures and things of size 1 to 2, y up, facing +z. `cells` is the
/// resolution; below 48 thin limbs may touch themselves.
Mesh animal(int cells = 48);               ///< body, four legs, neck, head, tail; its length runs along z
Mesh man(int cells = 48);                  ///< torso, arms, legs, head
Mesh bust(unsigned seed, int cells = 48);  ///< head, neck, shoulders; another face for another seed
Mesh bush(unsigned seed, int cells = 48);
Mesh glasses(int cells = 64);  ///< two rims, a bridge, two temples: genus 2
Mesh hat(int around = 48);     ///< a crown, hollow from below, and a brim

Mesh moved(Mesh mesh, const Eigen::Affine3d& by);
/// All in one mesh, with the optional arrays that all of them have.
Mesh together(const std::vector<Mesh>& meshes);
/// Flags the faces whose centre passes.
std::vector<char> faces_where(const Mesh& mesh, const std::function<bool(const Vec3& center)>& pass);

/// The share (by area) of the faces that lies farthest along a direction.
std::vector<char> share_along(const Mesh& mesh, const Vec3& direction, double share);

/// Numbers that are the same on every machine.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * double(engine_() >> 11) * 0x1p-53; }
  int below(int n) { return int(engine_() % unsigned(n)); }
  Vec3 direction();
  Eigen::Matrix3d rotation();

 private:
  std::mt19937_64 engine_;
};

/// Two closed models that overlap, and the faces to keep on their far sides.
struct Scene {
  Mesh a, b;
  std::vector<char> keep_a, keep_b;
};
Scene random_scene(unsigned seed);

}  // namespace parts::test
