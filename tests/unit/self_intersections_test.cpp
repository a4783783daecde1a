// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/self_intersections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "parts/mesh/predicates.h"
#include "support/shapes.h"

namespace parts {
namespace {

using namespace parts::test;

Mesh triangles(const std::vector<Vec3>& corners) {
  Mesh mesh;
  mesh.vertices = corners;
  for (int i = 0; i + 2 < int(corners.size()); i += 3) mesh.faces.push_back({i, i + 1, i + 2});
  return mesh;
}

TEST(Predicates, ExactOnThePlane) {
  // Points of a slanted plane whose coordinates have no short binary form.
  const Vec3 a(0.1, 0.7, 0.3), u(0.25, 0.125, -0.5), v(-0.75, 0.5, 0.0625);
  const Vec3 b = a + u, c = a + v;
  EXPECT_EQ(mesh::orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}), 1);
  EXPECT_EQ(mesh::orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 3, 0}), 0);
  const double tiny = 1e-300;
  EXPECT_EQ(mesh::orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 3, tiny}), -1);
  // Cyclic permutations agree, exchanges are opposite, however close to the plane.
  const Vec3 d = a + 0.3 * u + 0.3 * v;
  const int side = mesh::orientation(a, b, c, d);
  EXPECT_EQ(mesh::orientation(b, c, a, d), side);
  EXPECT_EQ(mesh::orientation(b, a, c, d), -side);
  EXPECT_EQ(mesh::orientation(a, b, d, c), -side);
}

TEST(Predicates, TinyTurns) {
  // Kettner et al., "Classroom examples of robustness problems": plain doubles fail here.
  const Vec3 p(12, 12, 0), q(24, 24, 0);
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const Vec3 r(0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53, 0);
      ASSERT_EQ(mesh::turn(r, p, q, 2), i < j ? 1 : i > j ? -1 : 0) << i << " " << j;
    }
}

TEST(SelfIntersections, CleanShapesHaveNone) {
  for (const Mesh& mesh : {sphere(), torus(), box({0, 0, 0}, {1, 1, 1}, 6), noisy_sphere({0, 0, 0}, 1, 4, 0.3, 7)})
    EXPECT_EQ(mesh::self_intersections(mesh), 0);
}

TEST(SelfIntersections, CrossingTriangles) {
  const std::vector<Vec3> base{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const auto with = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    std::vector<Vec3> all = base;
    all.insert(all.end(), {a, b, c});
    return mesh::self_intersections(triangles(all));
  };
  EXPECT_EQ(with({1, 1, -1}, {1, 1, 1}, {9, 9, 1}), 1);       // pierced
  EXPECT_EQ(with({1, 1, 0}, {1, 1, 1}, {9, 9, 1}), 1);        // touched by a corner
  EXPECT_EQ(with({1, 1, 1e-9}, {1, 1, 1}, {9, 9, 1}), 0);     // nearly
  EXPECT_EQ(with({-1, -1, -1}, {-1, -1, 1}, {9, -9, 0}), 0);  // crosses the plane outside
  EXPECT_EQ(with({1, 1, 0}, {2, 1, 0}, {1, 2, 0}), 1);        // inside, coplanar
  EXPECT_EQ(with({-9, -9, 0}, {20, -9, 0}, {-9, 20, 0}), 1);  // around, coplanar
  EXPECT_EQ(with({5, 5, 0}, {9, 5, 0}, {5, 9, 0}), 0);        // beside, coplanar
  EXPECT_EQ(with({-1, 1, 0}, {5, 1, 0}, {2, 1, 3}), 1);       // an edge across in the plane
  EXPECT_EQ(with({0, 0, 1}, {4, 0, 1}, {0, 4, 1}), 0);        // above
}

TEST(SelfIntersections, NeighboursThatFoldOrPierce) {
  const Vec3 o(0, 0, 0), x(4, 0, 0), y(0, 4, 0);
  EXPECT_EQ(mesh::self_intersections(triangles({o, x, y, x, o, {1, 1, 0}})), 1);    // folded on their side
  EXPECT_EQ(mesh::self_intersections(triangles({o, x, y, x, o, {1, -1, 0}})), 0);   // flat
  EXPECT_EQ(mesh::self_intersections(triangles({o, x, y, x, o, {1, 1, 0.1}})), 0);  // steep
  EXPECT_EQ(mesh::self_intersections(triangles({o, x, y, o, {1, 1, 1}, {1, 1, -1}})), 1);
  EXPECT_EQ(mesh::self_intersections(triangles({o, x, y, o, {-1, 1, 1}, {-1, 1, -1}})), 0);
  EXPECT_EQ(mesh::self_intersections(triangles({o, x, y, o, {9, 9, 1}, {9, 9, -1}})), 1);  // out through the far side
  EXPECT_EQ(mesh::self_intersections(triangles({o, x, y, o, x, y})), 1);                   // twice the same
}

TEST(SelfIntersections, DegenerateAndNonFiniteFacesAreLeftOut) {
  Mesh mesh = triangles({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 0}, {1, 1, 0}, {2, 2, 0}});
  EXPECT_EQ(mesh::self_intersections(mesh), 0);
  mesh.vertices[4].z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(mesh::self_intersections(mesh), 0);
  EXPECT_EQ(mesh::self_intersections({}), 0);
}

TEST(SelfIntersections, MatchesAllPairsForAnyThreadsAndScale) {
  for (double scale : {1e-6, 1., 1e6}) {
    Random random(5);
    std::vector<Vec3> corners;
    for (int i = 0; i < 300; ++i) {
      const Vec3 c(random.uniform(0, 5), random.uniform(0, 5), random.uniform(0, 5));
      for (int k = 0; k < 3; ++k) {
        Vec3 p = c + random.direction();
        if (i % 3 == 0) p = p.array().round();  // many coplanar and touching ones
        corners.push_back(scale * p);
      }
    }
    const Mesh mesh = triangles(corners);
    const auto pairs = mesh::intersecting_faces(mesh, 0, 1);
    EXPECT_EQ(pairs, mesh::intersecting_faces(mesh, 0, 2));
    EXPECT_EQ(pairs, mesh::intersecting_faces(mesh, 0, 7));
    long slow = 0;
    for (int f = 0; f < mesh.face_count(); ++f)
      for (int g = f + 1; g < mesh.face_count(); ++g) {
        std::vector<Vec3> six;
        for (int face : {f, g})
          for (int k = 0; k < 3; ++k) six.push_back(mesh.corner(face, k));
        slow += mesh::self_intersections(triangles(six));
      }
    EXPECT_EQ(long(pairs.size()), slow);
    EXPECT_GT(slow, 100);
    const auto some = mesh::intersecting_faces(mesh, 10, 1);
    EXPECT_EQ(some.size(), 10u);
    EXPECT_EQ(some, mesh::intersecting_faces(mesh, 10, 5));
  }
}

TEST(SelfIntersections, CountsTheSeamOfTwoSpheres) {
  const Mesh two = together({sphere({0, 0, 0}, 1, 3), sphere({0.7, 0.1, 0.2}, 1, 3)});
  EXPECT_GT(mesh::self_intersections(two), 100);
  EXPECT_EQ(mesh::self_intersections(two, 5), 5);
}

}  // namespace
}  // namespace parts
