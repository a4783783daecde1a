// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever is stitched, no edge gets more than two faces and no vertex more than one fan.
#include "parts/seam/cap.h"
#include "parts/seam/pieces.h"
#include "parts/seam/stitch.h"
#include "unit/seam_support.h"

namespace parts::test {
namespace {

/// A rough function of space, different for each seed, zero here and there near the plane.
std::function<double(const Vec3&)> rough(Random& random, const Vec3& normal, double at) {
  const double height = random.uniform(0, 0.4);
  std::vector<std::pair<Vec3, double>> waves;
  for (int i = 0; i < 4; ++i) waves.emplace_back(random.uniform(2, 14) * random.direction(), random.uniform(0, 6.28));
  return [=](const Vec3& p) {
    double sum = 0;
    for (const auto& [k, phase] : waves) sum += std::sin(k.dot(p) + phase);
    return p.dot(normal) - at + 0.25 * height * sum;
  };
}

Mesh any_shape(Random& random, bool open) {
  const int kind = random.below(4), fineness = 1 + random.below(3);
  Mesh mesh = kind == 0   ? box({-0.8, -0.7, -0.9}, {0.8, 0.7, 0.9}, 1 + random.below(5))
              : kind == 1 ? torus(Vec3::Zero(), 0.8, 0.4, 8 + random.below(30), 5 + random.below(12))
                          : noisy_sphere(Vec3::Zero(), 1, fineness, 0.3, unsigned(random.below(1000)));
  if (open) mesh = without(mesh, [d = random.direction()](const Vec3& c) { return c.dot(d) > 0.6; });
  return mesh;
}

TEST(SeamManifold, NoEdgeAndNoVertexThatTheInputsDidNotHave) {
  Random random(21);
  int runs = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const bool open = trial % 3 == 0, same = trial % 5 == 0;
    const cut::Model a = model_of(any_shape(random, open)), b = same ? a : model_of(any_shape(random, open));
    const auto field = rough(random, random.direction(), random.uniform(-0.3, 0.3));
    const double gap = trial % 4 ? random.uniform(0, 0.1) : 0, max_edge = trial % 2 ? 1e9 : 0.1;
    const seam::Clipped ca = clip_by(
                            a, [&](const Vec3&p) { return field(p) - gap; }, max_edge),
                        cb = clip_by(
                            b, [&](const Vec3&p) { return -field(p) - gap; }, max_edge);
    const mesh::MeshCheck before_a = welded_check(ca.mesh), before_b = welded_check(cb.mesh);
    if (!before_a.manifold() || !before_b.manifold()) continue;
    const Stitched s = stitched(a, ca, b, cb, random.uniform(0.05, 0.5));
    if (s.mesh().faces.empty()) continue;
    ++runs;
    const mesh::MeshCheck raw = mesh::check(s.mesh());
    EXPECT_EQ(raw.nonmanifold_edges, 0) << trial << "\n" << mesh::to_string(raw);
    EXPECT_EQ(raw.inconsistent_edges, 0) << trial;
    seam::Joined finished = s.joined;
    seam::finish_seam(finished, 0.1, cut::Cut::Mesh, {}, 1);
    const mesh::MeshCheck c = welded_check(finished.mesh);
    EXPECT_EQ(c.nonmanifold_edges, 0) << trial << "\n" << mesh::to_string(c);
    EXPECT_EQ(c.nonmanifold_vertices, 0) << trial << "\n" << mesh::to_string(c);
    if (!open) {
      EXPECT_TRUE(c.closed()) << trial << "\n" << mesh::to_string(c);
    }
  }
  EXPECT_GT(runs, 400);
}

TEST(SeamManifold, ACapMakesNoEdgeThatIsThere) {
  // A triangle with an ear on each side: every other corner of the contour shares an edge already.
  Mesh mesh;
  const int n = 6;
  for (int i = 0; i < n; ++i) mesh.vertices.emplace_back(std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n), 0);
  for (int i = 0; i < n; i += 2) mesh.faces.push_back({i, (i + 1) % n, (i + 2) % n});
  mesh.faces.push_back({0, 2, 4});
  const std::vector<mesh::Loop> border = mesh::trace_loops(mesh::boundary_half_edges(mesh));
  ASSERT_EQ(border.size(), 1u);
  ASSERT_EQ(border[0].size(), n);
  seam::cap(mesh, border[0], std::vector<int>(n, 0));
  const mesh::MeshCheck c = mesh::check(mesh);
  EXPECT_TRUE(c.manifold() && c.closed() && c.oriented()) << mesh::to_string(c);
  // A lone triangle has nothing but itself to be closed with.
  Mesh lone;
  lone.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  lone.faces = {{0, 1, 2}};
  seam::cap(lone, mesh::trace_loops(mesh::boundary_half_edges(lone))[0], {0, 0, 0});
  EXPECT_EQ(lone.vertex_count(), 4);
  EXPECT_TRUE(mesh::check(lone).closed() && mesh::check(lone).manifold());
}

}  // namespace
}  // namespace parts::test
