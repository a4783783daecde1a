// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "parts/spatial/closest_point.h"
#include "parts/spatial/point_tree.h"
#include "parts/spatial/triangle.h"

namespace parts::spatial {
namespace {

using Corners = std::array<Vec3, 3>;

Vec3 random_point(std::mt19937& random) {
  std::uniform_real_distribution<double> at(-1, 1);
  const double x = at(random), y = at(random);
  return {x, y, at(random)};
}

/// The least distance by a search over the triangle that narrows down, not by regions.
double searched_distance(const Corners& t, const Vec3& p) {
  double u = 1 / 3., v = 1 / 3., least = 1e300;
  for (double step = 1 / 3.; step > 1e-9; step *= 0.6) {
    const double u0 = u, v0 = v;
    for (int i = -3; i <= 3; ++i)
      for (int j = -3; j <= 3; ++j) {
        const double a = std::clamp(u0 + i * step / 2, 0.0, 1.0), b = std::clamp(v0 + j * step / 2, 0.0, 1.0 - a);
        const double d = (t[0] + a * (t[1] - t[0]) + b * (t[2] - t[0]) - p).norm();
        if (d < least) least = d, u = a, v = b;
      }
  }
  return least;
}

TEST(ClosestOnTriangle, NoPointOfTheTriangleIsCloser) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    const Corners t{random_point(random), random_point(random), random_point(random)};
    const Vec3 p = 2 * random_point(random);
    EXPECT_NEAR((closest_on_triangle(t, p) - p).norm(), searched_distance(t, p), 1e-6);
  }
}

TEST(ClosestOnTriangle, WithoutAreaItIsASegmentOrAPoint) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> share(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 a = random_point(random), b = random_point(random), p = 2 * random_point(random);
    const Vec3 between = a + share(random) * (b - a);
    const double at = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    const double expected = (a + at * (b - a) - p).norm();
    const Vec3 third = i % 3 == 0 ? a : i % 3 == 1 ? b : between;
    for (const Corners& t :
         {Corners{a, b, third}, {a, third, b}, {b, a, third}, {b, third, a}, {third, a, b}, {third, b, a}})
      EXPECT_NEAR((closest_on_triangle(t, p) - p).norm(), expected, 1e-7);
    EXPECT_EQ(closest_on_triangle({a, a, a}, p), a);
  }
}

TEST(ClosestOnTriangle, ACornerASideTheInside) {
  const Corners t{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 2, 0)};
  EXPECT_EQ(closest_on_triangle(t, {-1, -1, 1}), Vec3(0, 0, 0));
  EXPECT_EQ(closest_on_triangle(t, {1, -1, 0}), Vec3(1, 0, 0));
  EXPECT_EQ(closest_on_triangle(t, {2, 2, 0}), Vec3(1, 1, 0));
  EXPECT_EQ(closest_on_triangle(t, {0.5, 0.5, 7}), Vec3(0.5, 0.5, 0));
}

TEST(TriangleTree, FindsTheClosestWhateverTheHint) {
  std::mt19937 random(3);
  Surface surface;
  for (int i = 0; i < 500; ++i) {
    const Vec3 at = random_point(random);
    surface.triangles.push_back({at, at + 0.1 * random_point(random), at + 0.1 * random_point(random)});
    surface.normals.push_back(Vec3::UnitZ());
  }
  const TriangleTree tree(surface);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = 1.5 * random_point(random);
    double least = 1e300;
    for (const Corners& t : surface.triangles) least = std::min(least, (closest_on_triangle(t, p) - p).norm());
    int first = 0, other = int(random() % 500);
    const Closest a = tree.closest(p, first), b = tree.closest(p, other);
    EXPECT_DOUBLE_EQ((a.point - p).norm(), least);
    EXPECT_EQ(a.triangle, b.triangle);
  }
}

template <int Dimensions>
void expect_exact(int count, int asked) {
  std::mt19937 random(4);
  std::uniform_int_distribution<int> at(0, 9);  // a coarse lattice: many points are equally close
  const auto some = [&] {
    typename PointTree<Dimensions>::Point p;
    for (float& x : p) x = float(at(random));
    return p;
  };
  std::vector<typename PointTree<Dimensions>::Point> points(count);
  for (auto& p : points) p = some();
  const PointTree<Dimensions> tree(points);
  for (int i = 0; i < asked; ++i) {
    const auto p = some();
    int first = -1;
    float least = 1e30f;
    for (int k = 0; k < count; ++k) {
      float d = 0;
      for (int c = 0; c < Dimensions; ++c) d += (p[c] - points[k][c]) * (p[c] - points[k][c]);
      if (d < least) least = d, first = k;
    }
    const auto found = tree.nearest(p);
    EXPECT_EQ(found.squared, least);
    EXPECT_EQ(found.index, first);
  }
}

TEST(PointTree, IsExactAndTakesTheFirstOfEquallyCloseOnes) {
  expect_exact<3>(1, 5);
  expect_exact<3>(400, 500);
  expect_exact<6>(3000, 500);
}

}  // namespace
}  // namespace parts::spatial
