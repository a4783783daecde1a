// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#define MAXFLOW_INCLUDE_TEMPLATE_IMPLEMENTATION
#include <maxflow.h>

#include <cstdlib>

#include "parts/base/error.h"
#include "parts/cut/isolated.h"
#include "parts/cut/labels.h"
#include "parts/cut/volume.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

using WideGraph = maxflow::Graph<std::int64_t, std::int64_t, std::int64_t>;
constexpr std::int64_t kForbidden = std::int64_t(1) << 52;

Mesh small_shape(Random& random) {
  switch (random.below(5)) {
    case 0:
      return sphere(Vec3::Zero(), random.uniform(0.6, 1), 2);
    case 1:
      return torus(Vec3::Zero(), 0.8, random.uniform(0.15, 0.4), 24, 12);
    case 2:
      return box(Vec3(-0.8, -0.5, -0.6), Vec3(0.8, 0.5, 0.6), 3);
    case 3:
      return noisy_sphere(Vec3::Zero(), 1, 2, random.uniform(0.2, 0.7), unsigned(random.below(1000)));
    default:
      return tube({{{-0.9, 0, 0}, 0.2}, {{0, 0.4, 0}, 0.3}, {{0.9, 0, 0.2}, 0.25}}, 10);
  }
}

/// Two models in a grid of about n³: a third of them near-coincident copies, a
/// third cut by a volume that leaves surface outside; constraints anywhere.
cut::JointVoxels random_voxels(unsigned seed, int n) {
  Random random(seed);
  for (;;) try {
      const Mesh shape = small_shape(random);
      const bool copy = random.below(3) == 0;
      cut::Part a{moved(shape, Eigen::Affine3d(random.rotation())), {}}, b;
      Eigen::Affine3d place = Eigen::Affine3d::Identity();
      place.translation() = random.direction() * (copy ? random.uniform(0, 0.1) : random.uniform(0.2, 1.2));
      place.linear() *= random.uniform(0.9, 1.1);
      if (copy)
        b.mesh = moved(a.mesh, place);
      else
        b.mesh = moved(moved(small_shape(random), Eigen::Affine3d(random.rotation())), place);
      for (cut::Part* part : {&a, &b}) {
        const Vec3 center = part->mesh.vertices[random.below(part->mesh.vertex_count())];
        const double radius = random.uniform(0.15, 0.5);
        part->keep = faces_where(part->mesh, [&](const Vec3& c) { return (c - center).norm() < radius; });
        part->keep[random.below(part->mesh.face_count())] = 1;
      }
      cut::Model ma = cut::make_model(a, "A"), mb = cut::make_model(b, "B");
      Box volume = cut::transition_volume(ma, mb, Box());
      if (random.below(3) == 0)
        volume = cut::transition_volume(ma, mb, Box(-random.uniform(0.5, 0.9) * Vec3::Ones(), Vec3::Ones()));
      cut::JointVoxels voxels = cut::joint_voxels(ma, mb, volume, n, 1);
      for (std::uint8_t& flags : voxels.flags)
        if ((flags & cut::kKeepA) && (flags & cut::kKeepB)) flags &= std::uint8_t(~cut::kKeepB);
      return voxels;
    } catch (const UserError&) {  // the volume misses something: another try
    }
}

/// The cost of a cut as equations 1 and 2 count it.
struct Cost {
  long boundary = 0, intersection = 0, empty = 0;
  bool operator==(const Cost& o) const { return boundary == o.boundary && intersection == o.intersection; }
};
std::ostream& operator<<(std::ostream& out, const Cost& c) {
  return out << c.boundary << " boundary, " << c.intersection << " intersection, " << c.empty << " empty";
}

/// Visits the N6 edges of the full grid with their kind: 0 where one end is
/// empty, 1 at intersection voxels, 2 where only boundary voxels meet.
template <class Visit>
void for_each_full_edge(const cut::JointVoxels& voxels, const Visit& visit) {
  const cut::Grid& g = voxels.grid;
  for (std::size_t v = 0; v < g.count(); ++v) {
    const auto c = g.cell(v);
    for (int d = 0; d < 3; ++d) {
      std::array<int, 3> n = c;
      if (++n[d] >= g.dims[d]) continue;
      const std::size_t u = g.index(n[0], n[1], n[2]);
      const int p = voxels.set.node(v), q = voxels.set.node(u);
      visit(v, u, p < 0 || q < 0 ? 0 : voxels.both(p) || voxels.both(q) ? 1 : 2);
    }
  }
}
/// Outer pieces come after the voxels; they can be parted from intersection voxels.
template <class Visit>
void for_each_piece_edge(const cut::JointVoxels& voxels, const Visit& visit) {
  for (std::size_t k = 0; k < voxels.outer.size(); ++k)
    for (std::size_t v : voxels.outer[k].voxels)
      visit(voxels.grid.count() + k, v, voxels.both(voxels.set.node(v)) ? 1 : 3);
}

/// The minimum over all cuts of the full grid, empty voxels included, by
/// lexicographic integers; and the check that the labels found really cost it.
Cost full_grid_minimum(const cut::JointVoxels& voxels) {
  std::int64_t count[4] = {0, 0, 0, 0};
  const auto add = [&](std::size_t, std::size_t, int kind) { ++count[kind]; };
  for_each_full_edge(voxels, add), for_each_piece_edge(voxels, add);
  const std::int64_t weight[4] = {1, count[0] + 1, (count[0] + 1) * (count[1] + 1), kForbidden};
  EXPECT_LT(double(weight[2]) * double(count[2]), double(kForbidden));
  const int n = int(voxels.grid.count()), pieces = int(voxels.outer.size());
  WideGraph graph(n + pieces, 3 * n);
  graph.add_node(n + pieces);
  const auto join = [&](std::size_t v, std::size_t u, int kind) {
    graph.add_edge(int(v), int(u), weight[kind], weight[kind]);
  };
  for_each_full_edge(voxels, join), for_each_piece_edge(voxels, join);
  for (int p = 0; p < voxels.size(); ++p)
    graph.add_tweights(int(voxels.cells[p]), voxels.flags[p] & cut::kKeepA ? kForbidden : 0,
                       voxels.flags[p] & cut::kKeepB ? kForbidden : 0);
  for (int k = 0; k < pieces; ++k)
    if (voxels.outer[k].keep)
      graph.add_tweights(n + k, voxels.outer[k].of_a ? kForbidden : 0, voxels.outer[k].of_a ? 0 : kForbidden);
  const std::int64_t flow = graph.maxflow();
  Cost recount;
  const auto tally = [&](std::size_t v, std::size_t u, int kind) {
    if (graph.what_segment(int(v)) != graph.what_segment(int(u)))
      ++(kind == 0 ? recount.empty : kind == 1 ? recount.intersection : recount.boundary);
  };
  for_each_full_edge(voxels, tally), for_each_piece_edge(voxels, tally);
  const Cost cost{long(flow / weight[2]), long(flow % weight[2] / weight[1]), long(flow % weight[1])};
  EXPECT_EQ(recount, cost);
  EXPECT_EQ(recount.empty, cost.empty);
  return cost;
}

Cost cost_of(const cut::JointVoxels& voxels, const cut::VoxelLabels& cut) {
  Cost cost;
  const auto label = [&](std::size_t v) {
    return v < voxels.grid.count() ? cut.label[voxels.set.node(v)] : cut.outer[v - voxels.grid.count()];
  };
  const auto tally = [&](std::size_t v, std::size_t u, int kind) {
    if (kind && label(v) != label(u)) ++(kind == 1 ? cost.intersection : cost.boundary);
  };
  for_each_full_edge(voxels, tally), for_each_piece_edge(voxels, tally);
  return cost;
}

void expect_constraints_hold(const cut::JointVoxels& voxels, const cut::VoxelLabels& cut) {
  for (int p = 0; p < voxels.size(); ++p) {
    EXPECT_TRUE(!(voxels.flags[p] & cut::kKeepA) || cut.label[p] != cut::VoxelLabels::kB);
    EXPECT_TRUE(!(voxels.flags[p] & cut::kKeepB) || cut.label[p] != cut::VoxelLabels::kA);
  }
  ASSERT_EQ(cut.outer.size(), voxels.outer.size());
  for (std::size_t k = 0; k < cut.outer.size(); ++k)
    EXPECT_TRUE(!voxels.outer[k].keep || (cut.outer[k] == cut::VoxelLabels::kA) == voxels.outer[k].of_a);
}

void expect_thesis_optimum(const cut::JointVoxels& voxels, const char* what) {
  const cut::VoxelLabels cut = cut::thesis_cut(voxels);
  const Cost best = full_grid_minimum(voxels), found = cost_of(voxels, cut);
  EXPECT_EQ(found, best) << what;
  long k = 0;
  for (int p = 0; p < voxels.size(); ++p) k += voxels.both(p);
  EXPECT_NEAR(cut.cost, double(found.boundary) + double(found.intersection) / (10.0 * double(std::max(k, 1L))),
              1e-9 * (1 + cut.cost));
  EXPECT_EQ(cut.connected, found.boundary + found.intersection > 0) << what;
  expect_constraints_hold(voxels, cut);
}

TEST(ThesisCut, CostsTheMinimumOfTheFullGridIn240Scenes) {
  int connected = 0, with_pieces = 0;
  for (unsigned seed = 0; seed < 240; ++seed) {
    const int n = seed % 24 == 0 ? 32 : 8 + int(seed % 13);
    const cut::JointVoxels voxels = random_voxels(seed, n);
    expect_thesis_optimum(voxels, ("scene " + std::to_string(seed)).c_str());
    connected += cut::thesis_cut(voxels).connected, with_pieces += !voxels.outer.empty();
  }
  EXPECT_GT(connected, 180);
  EXPECT_GT(with_pieces, 20);
}

TEST(ThesisCut, CostsTheMinimumOfTheFullGridAt64) { expect_thesis_optimum(random_voxels(1003, 62), "scene 1003"); }

TEST(ThesisCut, CountsAsTheEquationsDo) {
  // A row of voxels: A A (A B) (A B) B B, constraints at its ends. The cut
  // passes at an intersection voxel: one edge of 1/(10 k), k = 2.
  cut::Grid grid;
  grid.dims = {6, 1, 1};
  cut::VoxelSet a(6), b(6), keep_a(6), keep_b(6);
  for (const int i : {0, 1, 2, 3}) a.add(std::size_t(i));
  for (const int i : {2, 3, 4, 5}) b.add(std::size_t(i));
  keep_a.add(0), keep_b.add(5);
  const cut::VoxelLabels cut = cut::thesis_cut(cut::join(grid, a, b, keep_a, keep_b));
  EXPECT_DOUBLE_EQ(cut.cost, 1 / 20.);
  EXPECT_TRUE(cut.connected);
  EXPECT_EQ(cut.label.front(), cut::VoxelLabels::kA);
  EXPECT_EQ(cut.label.back(), cut::VoxelLabels::kB);
  // Without an intersection voxel the two meet between 2 and 3: a boundary edge.
  cut::VoxelSet short_a(6), short_b(6);
  for (const int i : {0, 1, 2}) short_a.add(std::size_t(i)), short_b.add(std::size_t(i + 3));
  EXPECT_DOUBLE_EQ(cut::thesis_cut(cut::join(grid, short_a, short_b, keep_a, keep_b)).cost, 1);
  cut::VoxelSet far_b(6);
  far_b.add(4), far_b.add(5);
  EXPECT_FALSE(cut::thesis_cut(cut::join(grid, short_a, far_b, keep_a, keep_b)).connected);
}

TEST(LabelIsolated, TakesTheNearestDecidedLabel) {
  cut::Grid grid;
  grid.dims = {9, 1, 1};
  cut::VoxelSet a(9), b(9), none(9);
  for (const int i : {0, 2, 5, 8}) a.add(std::size_t(i));
  const cut::JointVoxels voxels = cut::join(grid, a, b, none, none);
  std::vector<std::int8_t> label{cut::VoxelLabels::kA, 0, 0, cut::VoxelLabels::kB};
  cut::label_isolated(voxels, {-1, 0, 1, -1}, 2, label);
  EXPECT_EQ(label, (std::vector<std::int8_t>{1, 1, -1, -1}));
  std::vector<std::int8_t> untouched{0, 0, 0, 0};
  cut::label_isolated(voxels, {0, 0, 0, 0}, 1, untouched);  // nobody to ask
  EXPECT_EQ(untouched, (std::vector<std::int8_t>{0, 0, 0, 0}));
}

}  // namespace
}  // namespace parts::test
