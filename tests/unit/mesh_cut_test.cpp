// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/mesh_cut.h"

#include "parts/cut/face_triangulation.h"
#include "parts/spatial/face_tree.h"
#include "unit/compose_support.h"

namespace parts::test {
namespace {

double grid_area(const cut::FaceTriangulation& t, const Triangle& f) {
  const Vec3 a = t.barycentric(f[0]), b = t.barycentric(f[1]), c = t.barycentric(f[2]);
  return 0.5 * ((b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]));
}

TEST(FaceTriangulation, CoversTheFaceOnceWhateverCrosses) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    cut::FaceTriangulation t;
    std::vector<int> vertices{0, 1, 2};
    for (int k = random.below(12); k-- > 0;)
      vertices.push_back(
          t.add_on_side(random.below(3), 1 + random.below(1000) * (cut::FaceTriangulation::kUnit / 1001)));
    for (int k = random.below(20); k-- > 0;) {
      Vec3 l(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
      if (seed % 4 == 0) l = (8 * l).array().round().matrix() + Vec3::Ones();  // many on one line
      vertices.push_back(t.add_inside(l / l.sum()));
    }
    std::vector<std::array<int, 2>> lines;
    for (int k = random.below(12); k-- > 0;)
      lines.push_back({vertices[random.below(int(vertices.size()))], vertices[random.below(int(vertices.size()))]});
    for (const auto& [u, v] : lines) t.constrain(u, v);
    t.improve({Vec3(0, 0, 0), Vec3(1, 0, 0.3), Vec3(0.2, 1, -1)});
    double sum = 0;
    std::map<std::array<int, 2>, int> sides;
    for (const Triangle& f : t.triangles()) {
      EXPECT_GT(grid_area(t, f), 0) << seed;
      sum += grid_area(t, f);
      for (int k = 0; k < 3; ++k) ++sides[{f[k], f[(k + 1) % 3]}];
    }
    EXPECT_NEAR(sum, 0.5, 1e-12) << seed;
    for (const auto& [side, count] : sides) EXPECT_EQ(count, 1) << seed;
    // Each line is a chain of edges: along it the next vertex is always an edge away.
    for (const auto& [u, v] : lines) {
      int at = u;
      for (int step = 0; at != v && step < 100; ++step) {
        const Vec3 to = t.barycentric(v) - t.barycentric(at);
        int next = -1;
        for (const auto& [side, count] : sides)
          for (int end : {0, 1}) {
            if (side[end] != at) continue;
            const Vec3 e = t.barycentric(side[1 - end]) - t.barycentric(at);
            if (e.cross(to.normalized()).norm() < 1e-7 && e.dot(to) > 0) next = side[1 - end];
          }
        ASSERT_GE(next, 0) << "line of seed " << seed << " ends on its way";
        at = next;
      }
      EXPECT_EQ(at, v) << seed;
    }
  }
}

TEST(SplitFaces, TheSurfaceStaysTheSame) {
  const Mesh mesh = noisy_sphere(Vec3::Zero(), 1, 3, 0.4, 5);
  Random random(3);
  std::vector<cut::SplitPoint> points;
  const std::vector<char> faces = faces_where(mesh, [](const Vec3& c) { return c.z() > 0; });
  cut::add_even_points(
      mesh, faces, std::vector<char>(mesh.vertices.size(), 0), 0.05, [](const Vec3&, double) { return true; }, points);
  ASSERT_GT(points.size(), 100u);
  const cut::SplitMesh split = cut::split_faces(mesh, points, std::vector<char>(points.size(), 1), {});
  const mesh::MeshCheck c = mesh::check(split.mesh);
  EXPECT_TRUE(c.closed() && c.manifold() && c.oriented()) << mesh::to_string(c);
  EXPECT_NEAR(volume_of(split.mesh), volume_of(mesh), 1e-9);
  double longest = 0;
  for (int f = 0; f < split.mesh.face_count(); ++f)
    if (faces[split.source[f]])
      for (int k = 0; k < 3; ++k)
        longest = std::max(longest, (split.mesh.corner(f, k) - split.mesh.corner(f, (k + 1) % 3)).norm());
  EXPECT_LE(longest, 0.1);
  // What is not split is there bit for bit.
  const std::set<FaceKey> keys = face_keys(split.mesh);
  const std::vector<char> far = faces_where(mesh, [](const Vec3& c) { return c.z() < -0.4; });
  for (int f = 0; f < mesh.face_count(); ++f) EXPECT_TRUE(!far[f] || keys.count(face_key(mesh, f)));
}

/// The mean distance of one clipped model's borders from another's.
double border_distance(const Mesh& a, const Mesh& b) {
  const auto edges = [](const Mesh& m) {
    Mesh out;
    for (const auto& loop : mesh::boundary_loops(m, mesh::edge_map(m)))
      for (int k = 0; k < loop.size(); ++k) {
        const int v = out.vertex_count();
        out.vertices.push_back(m.vertices[loop.vertices[k]]), out.vertices.push_back(m.vertices[loop.next(k)]);
        out.faces.push_back({v, v + 1, v + 1});
      }
    return out;
  };
  const Mesh of_a = edges(a), of_b = edges(b);
  const spatial::FaceTree tree(of_b);
  double sum = 0;
  for (const Vec3& p : of_a.vertices) sum += tree.nearest(p, 1e9).distance;
  return sum / std::max(1, of_a.vertex_count());
}

TEST(MeshCut, TheSeamMovesWithTheModels) {
  const Scene scene = random_scene(7);
  const cut::Part a{scene.a, scene.keep_a}, b{scene.b, scene.keep_b};
  const compose::ComposeResult plain = compose_quietly(a, b);
  const double scale = plain.report.scale;
  Random random(11);
  for (int k = 0; k < 6; ++k) {
    Eigen::Affine3d m = Eigen::Affine3d::Identity();
    m.translate(random.direction() * random.uniform(0, 50));
    m.rotate(random.rotation());
    m.scale(std::exp(random.uniform(-5, 5)));
    const compose::ComposeResult r = compose_quietly({moved(a.mesh, m), a.keep}, {moved(b.mesh, m), b.keep});
    EXPECT_LT(border_distance(moved(r.clipped_a, m.inverse()), plain.clipped_a), 0.002 * scale) << k;
    EXPECT_LT(border_distance(moved(r.clipped_b, m.inverse()), plain.clipped_b), 0.002 * scale) << k;
  }
}

TEST(MeshCut, SubdividingAModelHardlyMovesTheSeam) {
  const auto [a, b] = two_spheres(3);
  cut::Part fine{sphere({0, 0, 0}, 1, 5), {}};
  fine.keep = faces_where(fine.mesh, [](const Vec3& c) { return c.x() < -0.7; });
  const compose::ComposeResult coarse = compose_quietly(a, b), r = compose_quietly(fine, b);
  EXPECT_LT(border_distance(r.clipped_b, coarse.clipped_b), longest_edge(a.mesh));
}

TEST(MeshCut, BothBordersRunAlongTheCurveInWhichTheModelsCross) {
  const auto [a, b] = two_spheres(4);
  const compose::ComposeResult r = compose_quietly(a, b);
  EXPECT_LT(border_distance(r.clipped_a, r.clipped_b), 1e-9);
  EXPECT_GT(r.report.crossing_segments, 50);
  EXPECT_EQ(r.report.broken_ties, 0);
}

TEST(MeshCut, WhatMustGoGoes) {
  // A bar through a ball: without a mark both its ends stay.
  std::vector<Ball> path;
  for (int i = 0; i <= 40; ++i) path.push_back({{0.1 * i - 2, 0, 0}, 0.3});
  cut::Part a{sphere({0, 0, 0}, 1, 4), {}}, b{tube(path, 24), {}};
  a.keep = faces_where(a.mesh, [](const Vec3& c) { return c.z() > 0.8; });
  b.keep = faces_where(b.mesh, [](const Vec3& c) { return c.x() > 1.8; });
  b.drop = faces_where(b.mesh, [](const Vec3& c) { return c.x() < -1.8; });
  const compose::ComposeResult r = compose_quietly(a, b);
  expect_closed_manifold(r.composed, "one end");
  EXPECT_EQ(missing_faces(r, a, b), 0);
  EXPECT_GT(r.composed.bounds().min().x(), -1.1);
  EXPECT_EQ(mesh::check(r.composed).components, 1);
  compose::ComposeOptions thesis;
  thesis.cut = cut::Cut::Thesis;
  EXPECT_NE(user_error([&, &a = a, &b = b] { compose_quietly(a, b, thesis); }).find("Thesis"), std::string::npos);
}

TEST(RmsSize, DoesNotDependOnTheTessellation) {
  EXPECT_NEAR(cut::rms_size(box({-1, -1, -1}, {1, 1, 1}, 1)), std::sqrt(1 + 2. / 3), 1e-12);
  EXPECT_NEAR(cut::rms_size(box({-1, -1, -1}, {1, 1, 1}, 7)), std::sqrt(1 + 2. / 3), 1e-12);
}

TEST(SeamScore, CountsAsItsDefinitionDoes) {
  // Two facing straight borders of length 1, 0.05 apart, at a right angle; S = 1.
  const auto line = [](double y, const Vec3& normal) { return cut::BorderEdge{Vec3(0, y, 0), Vec3(1, y, 0), normal}; };
  cut::Borders a, b;
  a.cut = {line(0, Vec3::UnitZ())}, b.cut = {line(0.05, Vec3::UnitY())};
  const cut::SeamScore facing = cut::score_seam(a, b, 1);
  EXPECT_NEAR(facing.total(), (0.05 + 0.01 * (2 - 0)) / 0.01, 1e-9);
  b.cut = {line(0.5, Vec3::UnitY())};  // none within 0.1
  EXPECT_NEAR(cut::score_seam(a, b, 1).total(), (0.1 + 0.01 + 0.1) / 0.01, 1e-9);
  b.cut.clear(), b.own = {line(0, Vec3::UnitZ())};  // an open model's own border
  EXPECT_NEAR(cut::score_seam(a, b, 1).total(), 0.5 * 0.01 / 0.01, 1e-9);
}

}  // namespace
}  // namespace parts::test
