// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/scenes.h"

#include <cmath>
#include <map>

#include "parts/compose/constraint.h"

namespace parts::bench {
namespace {

/// The faces with x beyond the given share of the model's extent are kept.
cut::Part part(Mesh mesh, bool low_end) {
  constexpr double kShare = 0.2;
  Box box = mesh.bounds();
  const double x = low_end ? box.min()[0] + kShare * box.sizes()[0] : box.max()[0] - kShare * box.sizes()[0];
  (low_end ? box.max() : box.min())[0] = x;
  std::vector<char> keep = compose::constrained_faces(mesh, compose::ConstraintBy::Box, box.min(), box.max(), "");
  return {std::move(mesh), std::move(keep)};
}

int side_for(int faces) { return std::max(2, int(std::lround(std::sqrt(faces / 12.0)))); }

/// A bump of a radius function around a direction; larger `narrow`, narrower limb.
double limb(const Vec3& at, const Vec3& direction, double height, double narrow) {
  return height * std::exp(narrow * (at.dot(direction.normalized()) - 1));
}

double skin(const Vec3& d) {
  return 0.02 * std::sin(9 * d[0] + 2 * d[1]) * std::sin(8 * d[1] - 3 * d[2]) * std::sin(10 * d[2] + d[0]) +
         0.002 * std::sin(61 * d[0] + 3) * std::sin(57 * d[1] + 1) * std::sin(67 * d[2] + 2);
}

}  // namespace

Mesh ball(int n, const std::function<double(const Vec3&)>& radius) {
  Mesh mesh;
  std::map<std::array<int, 3>, int> number;  // by place on the cube's grid
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [it, fresh] = number.try_emplace(at, mesh.vertex_count());
    if (fresh) {
      // Equal angles instead of equal steps, so that corners are not crowded.
      Vec3 d;
      for (int k = 0; k < 3; ++k) d[k] = std::tan((double(at[k]) / n - 0.5) * M_PI / 2);
      d.normalize();
      mesh.vertices.push_back(radius(d) * d);
    }
    return it->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int end : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int u, int v) {
            std::array<int, 3> at;
            at[axis] = end, at[(axis + 1) % 3] = i + u, at[(axis + 2) % 3] = j + v;
            return vertex(at);
          };
          int q[4] = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          if (end == 0) std::swap(q[1], q[3]);
          mesh.faces.push_back({q[0], q[1], q[2]});
          mesh.faces.push_back({q[0], q[2], q[3]});
        }
  return mesh;
}

Mesh tube(double half_length, double radius, int rings, int sides) {
  Mesh mesh;
  mesh.vertices.push_back({-half_length, 0, 0});
  for (int i = 1; i < rings; ++i) {
    // Along the outline of a rectangle with round ends.
    const double way = (half_length - radius) * 2 + M_PI * radius, s = way * i / rings, quarter = M_PI * radius / 2;
    double x, r;
    if (s < quarter)
      x = -half_length + radius * (1 - std::cos(s / radius)), r = radius * std::sin(s / radius);
    else if (s > way - quarter)
      x = half_length - radius * (1 - std::cos((way - s) / radius)), r = radius * std::sin((way - s) / radius);
    else
      x = -half_length + radius + s - quarter, r = radius;
    for (int j = 0; j < sides; ++j) {
      const double angle = 2 * M_PI * (j + 0.5 * (i % 2)) / sides;
      mesh.vertices.push_back({x, r * std::cos(angle), r * std::sin(angle)});
    }
  }
  mesh.vertices.push_back({half_length, 0, 0});
  const auto at = [&](int ring, int j) { return 1 + (ring - 1) * sides + j % sides; };
  for (int j = 0; j < sides; ++j) {
    mesh.faces.push_back({0, at(1, j + 1), at(1, j)});
    mesh.faces.push_back({mesh.vertex_count() - 1, at(rings - 1, j), at(rings - 1, j + 1)});
    for (int i = 1; i + 1 < rings; ++i) {
      const int a = at(i, j), b = at(i, j + 1), c = at(i + 1, j), d = at(i + 1, j + 1);
      if (i % 2) {
        mesh.faces.push_back({a, b, c});
        mesh.faces.push_back({b, d, c});
      } else {
        mesh.faces.push_back({a, b, d});
        mesh.faces.push_back({a, d, c});
      }
    }
  }
  return mesh;
}

Mesh torus(double large, double small, int around, int across) {
  Mesh mesh;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * M_PI * i / around, v = 2 * M_PI * j / across, r = large + small * std::cos(v);
      mesh.vertices.push_back({r * std::cos(u), r * std::sin(u), small * std::sin(v)});
      const int i1 = (i + 1) % around, j1 = (j + 1) % across;
      const int a = i * across + j, b = i1 * across + j, c = i1 * across + j1, d = i * across + j1;
      mesh.faces.push_back({a, b, c});
      mesh.faces.push_back({a, c, d});
    }
  return mesh;
}

void move(Mesh& mesh, const Vec3& by) {
  for (Vec3& p : mesh.vertices) p += by;
}

Box bounds(const cut::Part& a, const cut::Part& b) { return a.mesh.bounds().merged(b.mesh.bounds()); }

Scene two_spheres(int faces) {
  const int n = side_for(faces);
  Mesh a = ball(n, [](const Vec3&) { return 1.0; }), b = ball(n, [](const Vec3&) { return 0.9; });
  move(b, {1.1, 0.21, 0.13});
  return {"spheres", part(std::move(a), true), part(std::move(b), false)};
}

Scene two_tubes(int faces) {
  const int sides = std::max(6, int(std::sqrt(faces / 4.0))), rings = faces / sides / 2 + 1;
  Mesh a = tube(1, 0.3, rings, sides), b = tube(0.9, 0.27, rings, sides);
  const Eigen::AngleAxisd turn(0.5, Vec3(0.1, 0.2, 1).normalized());
  for (Vec3& p : b.vertices) p = turn * p;
  move(b, {1.25, 0.35, 0.02});
  return {"tubes", part(std::move(a), true), part(std::move(b), false)};
}

Scene two_tori(int faces) {
  const int across = std::max(6, int(std::sqrt(faces / 6.0))), around = faces / across / 2;
  Mesh a = torus(1, 0.3, around, across), b = a;
  for (Vec3& p : b.vertices) p = Vec3(p[1], p[2], p[0]);  // around y: its tube crosses a's
  move(b, {2.0, 0.1, 0.03});
  return {"tori", part(std::move(a), true), part(std::move(b), false)};
}

Scene two_creatures(int faces) {
  const int n = side_for(faces);
  Mesh a = ball(n, [](const Vec3& d) {  // hind part: tail and two legs
    return 0.6 + limb(d, {-1, 0.3, 0}, 0.7, 14) + limb(d, {0, -1, 0.5}, 0.8, 25) + limb(d, {0, -1, -0.5}, 0.8, 25) +
           limb(d, {1, 0, 0}, 0.4, 5) + skin(d);
  });
  Mesh b = ball(n, [](const Vec3& d) {  // front part: head and two arms
    return 0.55 + limb(d, {0.8, 0.8, 0}, 0.8, 16) + limb(d, {0.5, -0.8, 0.6}, 0.7, 30) +
           limb(d, {0.5, -0.8, -0.6}, 0.7, 30) + limb(d, {-1, 0.1, 0}, 0.4, 5) + skin(Vec3(d[1], d[2], d[0]));
  });
  move(b, {1.35, 0.05, 0.03});
  return {"creatures", part(std::move(a), true), part(std::move(b), false)};
}

void fit(Scene& scene, const Vec3& sides) {
  const Box box = bounds(scene.a, scene.b);
  for (cut::Part* p : {&scene.a, &scene.b})
    for (Vec3& v : p->mesh.vertices) v = (v - box.min()).cwiseQuotient(box.sizes()).cwiseProduct(sides);
}

}  // namespace parts::bench
