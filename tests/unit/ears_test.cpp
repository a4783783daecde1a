// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/ears.h"

#include <gtest/gtest.h>

#include <ctime>
#include <map>

#include "support/shapes.h"

namespace parts::test {
namespace {

/// A star around the origin in the plane with the given normal: simple, mostly far from convex.
std::vector<Vec3> star(Random& random, int n, double least, const Eigen::Matrix3d& turned) {
  std::vector<Vec3> p;
  for (int i = 0; i < n; ++i) {
    const double u = 2 * M_PI * i / n, r = random.uniform(least, 1);
    p.push_back(turned * Vec3(r * std::cos(u), r * std::sin(u), 0));
  }
  return p;
}

Vec3 area_vector(const std::vector<Vec3>& p, const Triangle& t) { return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]); }

Vec3 area_vector(const std::vector<Vec3>& p) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < p.size(); ++i) sum += p[i].cross(p[(i + 1) % p.size()]);
  return sum;
}

/// Every side has one triangle that runs along it, every chord one on each side of it.
void expect_whole(const std::vector<Triangle>& triangles, int n) {
  ASSERT_EQ(int(triangles.size()), n - 2);
  std::map<std::array<int, 2>, int> sides;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
  for (int i = 0; i < n; ++i) EXPECT_EQ((sides[{i, (i + 1) % n}]), 1);
  for (const auto& [e, count] : sides)
    if (e[1] != (e[0] + 1) % n) {
      EXPECT_TRUE(count == 1 && sides.count({e[1], e[0]}) == 1) << e[0] << " to " << e[1];
    }
}

TEST(Ears, SimplePolygonsAreCutWithoutAFold) {
  Random random(5);
  for (int n = 3; n < 300; n += n < 12 ? 1 : 37)
    for (int trial = 0; trial < 10; ++trial) {
      const std::vector<Vec3> p = star(random, n, n < 5 ? 0.7 : 0.05, random.rotation());
      const Vec3 whole = area_vector(p);
      const std::vector<Triangle> triangles = mesh::cut_ears(p);
      expect_whole(triangles, n);
      double sum = 0;
      for (const Triangle& t : triangles) {
        EXPECT_GE(area_vector(p, t).dot(whole), -1e-12 * whole.squaredNorm()) << n << " corners, trial " << trial;
        sum += area_vector(p, t).norm();
      }
      EXPECT_NEAR(sum, whole.norm(), 1e-9 * sum) << n << " corners, trial " << trial;
    }
}

TEST(Ears, CrossedFlatAndBrokenPolygonsAreCutSomehow) {
  Random random(6);
  for (int n = 3; n < 60; n += 7) {
    std::vector<Vec3> crossed, line, point(n, Vec3(1, 2, 3));
    for (int i = 0; i < n; ++i) crossed.push_back(random.direction()), line.push_back(Vec3(i % 5, 0, 0));
    std::vector<Vec3> broken = crossed;
    broken[1].x() = std::nan("");
    for (const auto& p : {crossed, line, point, broken}) expect_whole(mesh::cut_ears(p), n);
  }
  EXPECT_TRUE(mesh::cut_ears({}).empty());
  EXPECT_TRUE(mesh::cut_ears({{0, 0, 0}, {1, 0, 0}}).empty());
}

TEST(Ears, ChordsThatMayNotBeMadeAreNotMade) {
  Random random(7);
  int cut = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 4 + random.below(12);
    const std::vector<Vec3> p = star(random, n, 0.5, random.rotation());
    std::map<std::array<int, 2>, bool> forbidden;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < i; ++j) forbidden[{j, i}] = random.below(3) == 0;
    const auto may_join = [&](int i, int j) { return !forbidden[{std::min(i, j), std::max(i, j)}]; };
    const std::vector<Triangle> triangles = mesh::cut_ears(p, may_join);
    if (triangles.empty()) continue;
    ++cut;
    expect_whole(triangles, n);
    for (const Triangle& t : triangles)
      for (int k = 0; k < 3; ++k) {
        const int i = t[k], j = t[(k + 1) % 3];
        EXPECT_TRUE(j == (i + 1) % n || i == (j + 1) % n || may_join(i, j));
      }
  }
  EXPECT_GT(cut, 100);
  const auto none = [](int, int) { return false; };
  EXPECT_TRUE(mesh::cut_ears({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, none).empty());
  EXPECT_EQ(mesh::cut_ears({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, none).size(), 1u);
}

TEST(Ears, ThousandsOfCornersAreNoCubicWork) {
  Random random(8);
  const auto seconds = [&](int n) {
    const std::vector<Vec3> p = star(random, n, 0.3, random.rotation());
    const std::clock_t from = std::clock();
    expect_whole(mesh::cut_ears(p), n);
    return double(std::clock() - from) / CLOCKS_PER_SEC;
  };
  const double small = std::max(seconds(2000), 1e-3);
  EXPECT_LT(seconds(16000), 64 * 2 * small);  // eight times the corners: quadratic is 64, cubic 512
}

}  // namespace
}  // namespace parts::test
