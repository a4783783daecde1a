// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <numeric>

#include "parts/mesh/self_intersections.h"
#include "parts/mesh/topology.h"

namespace parts::test {
namespace {

double volume(const Mesh& mesh) {
  double sum = 0;
  for (int f = 0; f < mesh.face_count(); ++f) sum += mesh.corner(f, 0).dot(mesh.corner(f, 1).cross(mesh.corner(f, 2)));
  return sum / 6;
}

struct Named {
  const char* name;
  Mesh mesh;
  int genus;
};

TEST(Shapes, AreClosedOrientedAndClean) {
  const std::vector<Named> all{
      {"box", box({-1, -1, -1}, {1, 2, 1}, 2), 0},
      {"sphere", sphere(), 0},
      {"noisy sphere", noisy_sphere({1, 2, 3}, 2, 4, 0.5, 3), 0},
      {"torus", torus(), 1},
      {"tube", tube({{{0, 0, 0}, 0.2}, {{0.2, 0, 1}, 0.3}, {{0.8, 0, 1.8}, 0.2}, {{1.8, 0, 2}, 0.2}}), 0},
      {"hat", hat(), 0},
      {"animal", animal(), 0},
      {"man", man(), 0},
      {"bust", bust(1), 0},
      {"bush", bush(1), 0},
      {"glasses", glasses(), 2},
  };
  for (const Named& shape : all) {
    const mesh::MeshCheck c = mesh::check(shape.mesh);
    EXPECT_TRUE(c.manifold() && c.closed() && c.oriented()) << shape.name << "\n" << mesh::to_string(c);
    EXPECT_EQ(c.components, 1) << shape.name;
    EXPECT_EQ(c.euler, 2 - 2 * shape.genus) << shape.name;
    EXPECT_EQ(c.degenerate_faces, 0) << shape.name;
    EXPECT_EQ(mesh::self_intersections(shape.mesh), 0) << shape.name;
    EXPECT_GT(volume(shape.mesh), 0) << shape.name;
  }
}

TEST(Shapes, SphereAndBoxHaveTheirVolume) {
  EXPECT_NEAR(volume(sphere({5, 6, 7}, 2, 5)), 4 / 3. * 3.14159265 * 8, 0.1);
  EXPECT_NEAR(volume(box({1, 1, 1}, {2, 3, 4}, 3)), 6, 1e-9);
  const auto mirror = Eigen::Affine3d(Eigen::Scaling(-1., 1., 1.));
  EXPECT_NEAR(volume(moved(box({0, 0, 0}, {1, 1, 1}), mirror)), 1, 1e-9);
}

TEST(Shapes, SeedsMatterAndRepeat) {
  EXPECT_EQ(bush(3, 20).vertices, bush(3, 20).vertices);
  EXPECT_NE(bush(3, 20).vertices, bush(4, 20).vertices);
  EXPECT_NE(bust(3, 20).vertices, bust(4, 20).vertices);
}

TEST(Shapes, RandomScenesOverlapAndKeepSomething) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Scene s = random_scene(seed);
    EXPECT_TRUE(s.a.bounds().intersects(s.b.bounds()));
    for (const auto* keep : {&s.keep_a, &s.keep_b}) EXPECT_GT(std::accumulate(keep->begin(), keep->end(), 0), 3);
    EXPECT_TRUE(mesh::check(s.a).manifold() && mesh::check(s.a).closed()) << seed;
    EXPECT_TRUE(mesh::check(s.b).manifold() && mesh::check(s.b).closed()) << seed;
  }
}

}  // namespace
}  // namespace parts::test
