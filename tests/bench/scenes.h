// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "parts/compose/compose.h"

namespace parts::bench {

/// A closed surface around the origin, `radius` away in each direction: a cube
/// whose sides are grids of n × n quads, blown up. 12 n² faces.
Mesh ball(int n, const std::function<double(const Vec3& direction)>& radius);

/// A closed tube along x of the given half length and radius, round at its
/// ends. About 2 rings × sides faces.
Mesh tube(double half_length, double radius, int rings, int sides);

/// A torus around z; 2 around × across faces.
Mesh torus(double large, double small, int around, int across);

void move(Mesh& mesh, const Vec3& by);
Box bounds(const cut::Part& a, const cut::Part& b);

/// Two models that overlap, each with its far end to be kept.
struct Scene {
  std::string name;
  cut::Part a, b;
};

/// About `faces` faces a model.
Scene two_spheres(int faces);
Scene two_tubes(int faces);
Scene two_tori(int faces);
/// Rough-skinned bodies with limbs, no two triangles alike.
Scene two_creatures(int faces);

/// Scales a scene, each axis by itself, so that its box starts at 0 and has the
/// given sides.
void fit(Scene& scene, const Vec3& sides);

}  // namespace parts::bench
