// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "parts/cut/joint.h"
#include "parts/cut/rasterize.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

/// A triangle against a box of half side `half`: all thirteen axes, in long
/// double, each axis' interval taken over the three corners.
bool overlaps(const std::array<Vec3, 3>& triangle, const Vec3& center, double half) {
  using V = Eigen::Matrix<long double, 3, 1>;
  V p[3];
  for (int k = 0; k < 3; ++k) p[k] = (triangle[k] - center).cast<long double>();
  std::vector<V> axes;
  const V e[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  for (int d = 0; d < 3; ++d) {
    axes.push_back(V::Unit(d));
    for (const V& x : e) axes.push_back(x.cross(V(V::Unit(d))));
  }
  axes.push_back(e[0].cross(e[1]));
  for (const V& axis : axes) {
    const long double a = axis.dot(p[0]), b = axis.dot(p[1]), c = axis.dot(p[2]), r = half * axis.cwiseAbs().sum();
    if (std::min({a, b, c}) > r || std::max({a, b, c}) < -r) return false;
  }
  return true;
}

cut::Grid unit_grid(int n) {
  cut::Grid g;
  g.dims = {n, n, n};
  return g;
}

std::set<std::size_t> voxels_of(const cut::Grid& grid, const std::array<Vec3, 3>& t) {
  std::set<std::size_t> found;
  cut::for_each_voxel(grid, t[0], t[1], t[2], [&](std::size_t v) {
    EXPECT_LT(v, grid.count());
    EXPECT_TRUE(found.insert(v).second) << "visited twice";
  });
  return found;
}

/// Nothing that the triangle touches is left out, nothing far from it is in.
void expect_conservative(const cut::Grid& grid, const std::array<Vec3, 3>& t) {
  const std::set<std::size_t> found = voxels_of(grid, t);
  for (std::size_t v = 0; v < grid.count(); ++v) {
    const auto [i, j, k] = grid.cell(v);
    const Vec3 center = grid.center(i, j, k);
    if (overlaps(t, center, 0.5)) {
      EXPECT_TRUE(found.count(v)) << "voxel " << i << " " << j << " " << k << " is missing";
    } else if (found.count(v)) {
      EXPECT_TRUE(overlaps(t, center, 0.5 + 1e-4)) << "voxel " << i << " " << j << " " << k << " is too many";
    }
  }
}

void expect_samples_inside(const cut::Grid& grid, const std::array<Vec3, 3>& t, Random& random) {
  const std::set<std::size_t> found = voxels_of(grid, t);
  for (int s = 0; s < 60; ++s) {
    double u = random.uniform(0, 1), v = random.uniform(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 p = grid.to_grid(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]));
    const int i = int(std::floor(p[0])), j = int(std::floor(p[1])), k = int(std::floor(p[2]));
    EXPECT_TRUE(!grid.inside(i, j, k) || found.count(grid.index(i, j, k)));
  }
}

Vec3 random_point(Random& random, double low, double high) {
  return {random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
}

TEST(Rasterize, AgreesWithSeparatingAxesOnEveryVoxel) {
  Random random(1);
  const cut::Grid grid = unit_grid(9);
  for (int n = 0; n < 300; ++n) {
    const double reach = n % 3 ? 12 : 40;  // some reach far out of the grid
    const Vec3 a = random_point(random, 4.5 - reach / 2, 4.5 + reach / 2);
    const double size = n % 4 ? reach : 0.7;
    const std::array<Vec3, 3> t{a, a + random.direction() * random.uniform(0, size),
                                a + random.direction() * random.uniform(0, size)};
    expect_conservative(grid, t);
    expect_samples_inside(grid, t, random);
  }
}

TEST(Rasterize, TrianglesOnVoxelSidesTouchBothNeighbours) {
  const cut::Grid grid = unit_grid(6);
  for (int axis = 0; axis < 3; ++axis) {
    std::array<Vec3, 3> t{Vec3(1.5, 1.5, 1.5), Vec3(4.5, 1.5, 1.5), Vec3(1.5, 4.5, 1.5)};
    for (Vec3& p : t) p = Vec3(p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]);
    for (Vec3& p : t)
      for (int d = 0; d < 3; ++d)
        if (t[0][d] == t[1][d] && t[0][d] == t[2][d]) p[d] = 2;
    expect_conservative(grid, t);
  }
  expect_conservative(grid, {Vec3(1, 1, 1), Vec3(3, 1, 1), Vec3(1, 3, 3)});  // corners on corners
  expect_conservative(grid, {Vec3(0, 0, 0), Vec3(6, 6, 6), Vec3(6, 0, 6)});
}

TEST(Rasterize, NeedlesSegmentsAndPoints) {
  Random random(2);
  const cut::Grid grid = unit_grid(9);
  for (int n = 0; n < 300; ++n) {
    const Vec3 a = random_point(random, 0.5, 8.5), d = random.direction() * random.uniform(0.1, 9);
    const double thick = n % 3 == 0 ? 0 : n % 3 == 1 ? 1e-15 : 1e-8;
    // The third corner lies on the segment but for rounding, or a trace beside it.
    const Vec3 c = a + random.uniform(-0.2, 1.2) * d + thick * random.direction();
    expect_conservative(grid, {a, a + d, c});
    expect_samples_inside(grid, {a, a + d, c}, random);
    expect_conservative(grid, {a, a + d, a});
    expect_conservative(grid, {a, a, a});
  }
}

TEST(Rasterize, HugeTrianglesCostNoMoreThanTheGrid) {
  Random random(3);
  const cut::Grid grid = unit_grid(9);
  for (int n = 0; n < 60; ++n) {
    const Vec3 through = random_point(random, 0, 9);
    const Vec3 u = random.direction(), v = u.cross(random.direction()).normalized();
    const double size = std::pow(10., random.uniform(2, 6));
    expect_conservative(grid, {through - size * u, through + size * v, through + size * (u - v)});
  }
  EXPECT_TRUE(voxels_of(grid, {Vec3(1e12, 0, 0), Vec3(1e12, 1e12, 0), Vec3(1e12, 0, 1e12)}).empty());
  EXPECT_TRUE(voxels_of(grid, {Vec3(-1, -1, -1), Vec3(-2, -1, -1), Vec3(-1, -3, -1)}).empty());
}

TEST(Rasterize, AClosedSurfaceHasNoLeak) {
  // From outside, N6 steps over unset voxels never come in.
  const Mesh mesh = noisy_sphere(Vec3::Zero(), 1, 3, 0.5, 4);
  const cut::Grid grid = cut::Grid::over(mesh.bounds(), 24);
  const cut::VoxelSet set = cut::rasterize(mesh, {}, grid, 1);
  std::vector<char> outside(grid.count(), 0);
  std::vector<std::size_t> stack{0};
  outside[0] = 1;
  while (!stack.empty()) {
    const auto c = grid.cell(stack.back());
    stack.pop_back();
    for (int d = 0; d < 3; ++d)
      for (const int step : {-1, 1}) {
        std::array<int, 3> n = c;
        n[d] += step;
        if (!grid.inside(n[0], n[1], n[2])) continue;
        const std::size_t v = grid.index(n[0], n[1], n[2]);
        if (!outside[v] && !set.has(v)) outside[v] = 1, stack.push_back(v);
      }
  }
  const Vec3 center = grid.to_grid(Vec3::Zero());
  EXPECT_FALSE(outside[grid.index(int(center[0]), int(center[1]), int(center[2]))]);
}

TEST(Rasterize, FlagsAndThreads) {
  const Mesh mesh = torus();
  const cut::Grid grid = cut::Grid::over(mesh.bounds(), 30);
  std::vector<char> flags = faces_where(mesh, [](const Vec3& c) { return c.x() > 0; });
  const cut::VoxelSet all = cut::rasterize(mesh, {}, grid, 1), half = cut::rasterize(mesh, flags, grid, 1);
  for (const int threads : {2, 3, 8}) {
    EXPECT_EQ(cut::rasterize(mesh, {}, grid, threads).cells(), all.cells());
    EXPECT_EQ(cut::rasterize(mesh, flags, grid, threads).cells(), half.cells());
  }
  EXPECT_GT(half.size(), 0);
  EXPECT_LT(half.size(), all.size());
  half.for_each([&](std::size_t v) { EXPECT_TRUE(all.has(v)); });
}

TEST(Grid, CoversTheBoxWithAVoxelAllAround) {
  Random random(4);
  for (int n = 0; n < 100; ++n) {
    const double scale = std::pow(10., random.uniform(-6, 6));
    const Vec3 low = scale * random_point(random, -5, 5) * std::pow(10., random.uniform(-6, 5));
    const Vec3 sides = scale * random_point(random, n % 5 ? 0.01 : 0, 1);
    const Box box(low, low + sides);
    const int resolution = 1 + random.below(100);
    const cut::Grid g = cut::Grid::over(box, resolution);
    EXPECT_NEAR(g.size * resolution, sides.maxCoeff(), 1e-6 * sides.maxCoeff());
    EXPECT_EQ(*std::max_element(g.dims.begin(), g.dims.end()), resolution + 2);
    const Vec3 from = g.to_grid(box.min()), to = g.to_grid(box.max());
    for (int d = 0; d < 3; ++d) {
      EXPECT_GE(from[d], 1 - 1e-3);
      EXPECT_LE(to[d], g.dims[d] - 1 + 1e-3);
    }
    for (int k = 0; k < 20; ++k) {
      const std::size_t v = std::size_t(random.uniform(0, double(g.count())));
      const auto c = g.cell(v);
      EXPECT_EQ(g.index(c[0], c[1], c[2]), v);
    }
  }
}

TEST(VoxelSet, RanksNumberTheSetVoxelsInOrder) {
  Random random(5);
  cut::VoxelSet set(1000), other(1000);
  std::set<std::size_t> expected;
  for (int n = 0; n < 200; ++n) {
    const std::size_t v = std::size_t(random.below(1000));
    set.add(v), expected.insert(v);
    other.add(std::size_t(random.below(1000)));
  }
  set.index(), other.index();
  ASSERT_EQ(set.size(), long(expected.size()));
  EXPECT_EQ(set.cells(), std::vector<std::size_t>(expected.begin(), expected.end()));
  int node = 0;
  for (std::size_t v = 0; v < 1000; ++v) EXPECT_EQ(set.node(v), expected.count(v) ? node++ : -1);
  cut::VoxelSet both = set, any = set;
  both &= other, any |= other;
  for (std::size_t v = 0; v < 1000; ++v) {
    EXPECT_EQ(both.has(v), set.has(v) && other.has(v));
    EXPECT_EQ(any.has(v), set.has(v) || other.has(v));
  }
}

TEST(JointVoxels, FlagsSayWhatPassesThrough) {
  const Mesh a = sphere(Vec3::Zero(), 1), b = sphere({0.8, 0, 0}, 1);
  const cut::Grid grid = cut::Grid::over(a.bounds().merged(b.bounds()), 24);
  const cut::VoxelSet va = cut::rasterize(a, {}, grid, 1), vb = cut::rasterize(b, {}, grid, 1);
  const auto left = faces_where(a, [](const Vec3& c) { return c.x() < -0.9; });
  const cut::VoxelSet keep = cut::rasterize(a, left, grid, 1), none(grid.count());
  const cut::JointVoxels voxels = cut::join(grid, va, vb, keep, none);
  long both = 0;
  for (int n = 0; n < voxels.size(); ++n) {
    const std::size_t c = voxels.cells[n];
    EXPECT_EQ((voxels.flags[n] & cut::kHasA) != 0, va.has(c));
    EXPECT_EQ((voxels.flags[n] & cut::kHasB) != 0, vb.has(c));
    EXPECT_EQ((voxels.flags[n] & cut::kKeepA) != 0, keep.has(c));
    EXPECT_FALSE(voxels.flags[n] & cut::kKeepB);
    const auto cell = grid.cell(c);
    EXPECT_EQ(voxels.at(cell[0], cell[1], cell[2]), n);
    both += voxels.both(n);
  }
  EXPECT_EQ(voxels.size(), va.size() + vb.size() - both);
  EXPECT_GT(both, 0);
  EXPECT_EQ(voxels.at(-1, 0, 0), -1);
  EXPECT_EQ(voxels.at(0, grid.dims[1], 0), -1);
}

}  // namespace
}  // namespace parts::test
