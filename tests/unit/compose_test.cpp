// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/attributes.h"
#include "unit/compose_support.h"

namespace parts::test {
namespace {

TEST(Compose, TwoSpheresBecomeOneSurfaceSeamedWhereTheyCross) {
  const auto [a, b] = two_spheres(4);
  const compose::ComposeResult r = compose_quietly(a, b);
  expect_closed_manifold(r.composed, "two spheres");
  const mesh::MeshCheck c = mesh::check(r.composed);
  EXPECT_EQ(c.components, 1);
  EXPECT_EQ(c.euler, 2);
  EXPECT_EQ(mesh::self_intersections(r.composed), 0);
  EXPECT_EQ(missing_faces(r, a, b), 0);
  // The union: two spheres less the lens of two caps of height 1/2.
  const double lens = 2 * M_PI * 0.25 * (3 - 0.5) / 3;
  EXPECT_NEAR(volume_of(r.composed), 2 * 4 * M_PI / 3 - lens, 0.05);
  EXPECT_EQ(r.report.loops_a, 1);
  EXPECT_EQ(r.report.loops_b, 1);
  EXPECT_EQ(r.report.loops_joined, 1);
  EXPECT_EQ(r.report.loops_capped + r.report.loops_open, 0);
  EXPECT_FALSE(r.report.reversed_b);
  EXPECT_NEAR(r.report.seam_length, 2 * M_PI * std::sqrt(0.75), 0.1);
  EXPECT_LT(r.report.seam_gap, 0.1 * r.report.seam_edge);
  // No staircase: both borders run along the true circle.
  for (const Mesh* clipped : {&r.clipped_a, &r.clipped_b})
    for (const auto& loop : mesh::boundary_loops(*clipped, mesh::edge_map(*clipped)))
      for (int v : loop) EXPECT_NEAR(clipped->vertices[v].x(), 0.5, 0.1 * r.report.seam_edge);
}

TEST(Compose, ReversedConstraintsGiveTheOtherPieces) {
  // Fig. 11: the inner caps instead of the outer ones make the lens.
  auto [a, b] = two_spheres(4);
  a.keep = faces_where(a.mesh, [](const Vec3& c) { return c.x() > 0.9; });
  b.keep = faces_where(b.mesh, [](const Vec3& c) { return c.x() < 0.1; });
  for (const cut::Cut cut : {cut::Cut::Mesh, cut::Cut::Thesis}) {
    compose::ComposeOptions options;
    options.cut = cut;
    const compose::ComposeResult r = compose_quietly(a, b, options);
    expect_closed_manifold(r.composed, "lens");
    EXPECT_EQ(missing_faces(r, a, b), 0);
    // Eq. 1-2 may snip a ring around a constraint instead of making the lens.
    if (cut == cut::Cut::Thesis) continue;
    EXPECT_NEAR(volume_of(r.composed), 2 * M_PI * 0.25 * (3 - 0.5) / 3, 0.05);
  }
}

TEST(Compose, TheOrderOfTheModelsDoesNotMatter) {
  const auto [a, b] = two_spheres(4);
  const compose::ComposeResult ab = compose_quietly(a, b), ba = compose_quietly(b, a);
  EXPECT_NEAR(volume_of(ab.composed), volume_of(ba.composed), 0.01);
  expect_closed_manifold(ba.composed, "B first");
}

TEST(Compose, AModelTurnedInsideOutGivesTheSameSurface) {
  for (const unsigned seed : {1u, 7u, 13u, 27u, 32u}) {
    const Scene scene = random_scene(seed);
    Mesh flipped = scene.b;
    mesh::flip_orientation(flipped);
    const compose::ComposeResult r = compose_quietly({scene.a, scene.keep_a}, {scene.b, scene.keep_b});
    const compose::ComposeResult turned = compose_quietly({scene.a, scene.keep_a}, {flipped, scene.keep_b});
    expect_closed_manifold(turned.composed, "flipped");
    EXPECT_NEAR(volume_of(turned.composed), volume_of(r.composed), 0.02 * volume_of(r.composed)) << seed;
    EXPECT_TRUE(turned.report.reversed_b != r.report.reversed_b) << seed;
  }
}

TEST(Compose, StitchOffGivesTheClippedParts) {
  const auto [a, b] = two_spheres();
  compose::ComposeOptions options;
  options.stitch = false;
  const compose::ComposeResult r = compose_quietly(a, b, options);
  EXPECT_EQ(r.composed.face_count(), r.clipped_a.face_count() + r.clipped_b.face_count());
  EXPECT_EQ(std::count(r.face_from_b.begin(), r.face_from_b.end(), 2), 0);
  const mesh::MeshCheck c = mesh::check(r.composed);
  EXPECT_EQ(c.components, 2);
  EXPECT_EQ(c.boundary_loops, r.report.loops_a + r.report.loops_b);
  EXPECT_EQ(r.report.loops_joined, 0);
  EXPECT_EQ(missing_faces(r, a, b), 0);
}

TEST(Compose, ResolutionIsTheUsersOrFromTheMeshes) {
  const auto [a, b] = two_spheres();
  compose::ComposeOptions options;
  options.cut = cut::Cut::Thesis;
  for (const int resolution : {12, 40, 100}) {
    options.resolution = resolution;
    const compose::ComposeResult r = compose_quietly(a, b, options);
    EXPECT_EQ(r.report.grid[0], resolution + 2);
    EXPECT_NEAR(r.report.voxel_size, 3. / resolution, 1e-9);
    expect_closed_manifold(r.composed, "resolution " + std::to_string(resolution));
  }
  const auto natural = [](const std::array<cut::Part, 2>& parts) {
    const cut::Model of_a = cut::make_model(parts[0], "A"), of_b = cut::make_model(parts[1], "B");
    return cut::natural_resolution(of_a, of_b, cut::transition_volume(of_a, of_b, Box()));
  };
  EXPECT_GT(natural(two_spheres(5)), natural({a, b}));
}

TEST(Compose, NothingIsCutOutsideTheVolume) {
  // Two long tubes side by side cross twice; the volume holds one crossing.
  cut::Part a{tube({{{-2, 0, 0}, 0.3}, {{-1, 0.2, 0}, 0.3}, {{0, 0.4, 0}, 0.3}, {{1, 0.2, 0}, 0.3}, {{2, 0, 0}, 0.3}}),
              {}};
  cut::Part b{
      tube({{{-2, 0.4, 0}, 0.3}, {{-1, 0.2, 0}, 0.3}, {{0, 0, 0}, 0.3}, {{1, 0.2, 0}, 0.3}, {{2, 0.4, 0}, 0.3}}), {}};
  a.keep = faces_where(a.mesh, [](const Vec3& c) { return c.x() < -2.1; });
  b.keep = faces_where(b.mesh, [](const Vec3& c) { return c.x() > 0.2 && c.x() < 0.4 && c.y() < -0.1; });
  compose::ComposeOptions options;
  options.volume = Box(Vec3(-2.5, -1, -1), Vec3(0.5, 1.5, 1));
  options.resolution = 60;
  for (const cut::Cut cut : {cut::Cut::Mesh, cut::Cut::Thesis}) {
    options.cut = cut;
    const compose::ComposeResult r = compose_quietly(a, b, options);
    EXPECT_EQ(missing_faces(r, a, b), 0);
    const std::set<FaceKey> of_a = face_keys(a.mesh), of_b = face_keys(b.mesh, r.report.reversed_b);
    for (int f = 0; f < r.composed.face_count(); ++f)
      EXPECT_TRUE(options.volume.contains(r.composed.face_box(f)) || of_a.count(face_key(r.composed, f)) ||
                  of_b.count(face_key(r.composed, f)) || r.face_from_b[f] == 2);
  }
}

TEST(Compose, OpenModelsGetNoNewBoundary) {
  auto [a, b] = two_spheres(4);
  const auto open = [](cut::Part& p, const std::function<bool(const Vec3&)>& hole) {
    const std::vector<char> away = faces_where(p.mesh, hole);
    std::vector<char> flags;
    for (char x : away) flags.push_back(!x);
    std::vector<int> old_face;
    p.mesh = mesh::take_faces(p.mesh, flags, nullptr, &old_face);
    std::vector<char> keep;
    for (int f : old_face) keep.push_back(p.keep[f]);
    p.keep = keep;
  };
  open(a, [](const Vec3& c) { return c.x() < -0.9 || c.x() > 0.9; });  // one hole is kept, the other one dropped
  open(b, [](const Vec3& c) { return c.x() > 1.9; });
  const compose::ComposeResult r = compose_quietly(a, b);
  const mesh::MeshCheck c = mesh::check(r.composed);
  EXPECT_TRUE(c.manifold() && c.oriented()) << mesh::to_string(c);
  EXPECT_EQ(c.boundary_loops, 2);
  EXPECT_EQ(c.components, 1);
  std::set<std::array<double, 3>> had;
  for (const Mesh* m : {&a.mesh, &b.mesh})
    for (const auto& loop : mesh::boundary_loops(*m, mesh::edge_map(*m)))
      for (int v : loop) had.insert({m->vertices[v][0], m->vertices[v][1], m->vertices[v][2]});
  for (const auto& loop : mesh::boundary_loops(r.composed, mesh::edge_map(r.composed)))
    for (int v : loop) {
      const Vec3& p = r.composed.vertices[v];
      EXPECT_TRUE(had.count({p[0], p[1], p[2]}));
    }
}

TEST(Compose, ASheetLaidAcrossASolidIsJoinedThroughItsBoundary) {
  // The border of the sheet's clip runs from boundary to boundary: it cannot close.
  Mesh sheet;
  constexpr int kSide = 24;
  for (int j = 0; j <= kSide; ++j)
    for (int i = 0; i <= kSide; ++i) sheet.vertices.emplace_back(4. * i / kSide - 1, j * 0.5 / kSide - 0.25, 0.02);
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const int v = j * (kSide + 1) + i;
      sheet.faces.push_back({v, v + 1, v + kSide + 2});
      sheet.faces.push_back({v, v + kSide + 2, v + kSide + 1});
    }
  cut::Part a{box({-1, -1, -1}, {1, 1, 0}, 12), {}}, b{sheet, {}};
  a.keep = faces_where(a.mesh, [](const Vec3& c) { return c.x() < -0.9; });
  b.keep = faces_where(b.mesh, [](const Vec3& c) { return c.x() > 2.5; });
  const compose::ComposeResult r = compose_quietly(a, b);
  const mesh::MeshCheck c = mesh::check(r.composed);
  EXPECT_EQ(c.nonmanifold_edges + c.inconsistent_edges, 0) << mesh::to_string(c);
  EXPECT_EQ(missing_faces(r, a, b), 0);
}

TEST(Compose, ScaleAndPlaceDoNotMatter) {
  const Scene scene = random_scene(7);
  const compose::ComposeResult plain = compose_quietly({scene.a, scene.keep_a}, {scene.b, scene.keep_b});
  const auto with = [&](const Eigen::Affine3d& m) {
    return compose_quietly({moved(scene.a, m), scene.keep_a}, {moved(scene.b, m), scene.keep_b});
  };
  for (const double scale : {0x1p-20, 0x1p20, 1e6, 1e-6}) {
    const compose::ComposeResult r = with(Eigen::Affine3d(Eigen::Scaling(scale)));
    expect_closed_manifold(r.composed, "scaled");
    EXPECT_NEAR(volume_of(r.composed) / std::pow(scale, 3), volume_of(plain.composed), 1e-2) << scale;
    EXPECT_EQ(mesh::check(r.composed).euler, mesh::check(plain.composed).euler);
    if (std::abs(std::log2(scale)) == 20) {  // a power of two rounds nothing
      EXPECT_EQ(r.composed.faces, plain.composed.faces) << scale;
    }
  }
  for (const Vec3& place : {Vec3(1e6, -1e6, 1e6), Vec3(-1e3, 1e6, 0)}) {
    const compose::ComposeResult r = with(Eigen::Affine3d(Eigen::Translation3d(place)));
    expect_closed_manifold(r.composed, "far away");
    EXPECT_EQ(mesh::check(r.composed).euler, mesh::check(plain.composed).euler);
    const Mesh back = moved(r.composed, Eigen::Affine3d(Eigen::Translation3d(-place)));
    EXPECT_NEAR(volume_of(back), volume_of(plain.composed), 1e-2);
  }
}

TEST(Compose, SmoothingStaysWithinItsDistance) {
  const auto [a, b] = two_spheres(4);
  compose::ComposeOptions options;
  options.smoothing.iterations = 0;
  const compose::ComposeResult rough = compose_quietly(a, b, options);
  options.smoothing.iterations = 20;
  options.smoothing.distance = 0.2;
  const compose::ComposeResult smooth = compose_quietly(a, b, options);
  ASSERT_EQ(smooth.composed.vertex_count(), rough.composed.vertex_count());
  double most = 0;
  for (int v = 0; v < rough.composed.vertex_count(); ++v) {
    const double move = (smooth.composed.vertices[v] - rough.composed.vertices[v]).norm();
    most = std::max(most, move);
    EXPECT_TRUE(move == 0 || std::abs(rough.composed.vertices[v].x() - 0.5) < 0.25);
  }
  EXPECT_GT(most, 0.01);
  EXPECT_EQ(missing_faces(smooth, a, b), 0);
}

TEST(Compose, CancellingAtAnyCallLeavesByCancelled) {
  const auto [a, b] = two_spheres();
  int calls = 0, last = 0;
  Progress counting([&](int percent, const char* stage) {
    EXPECT_GE(percent, 0);
    EXPECT_LE(percent, 100);
    EXPECT_STRNE(stage, "");
    last = percent;
    ++calls;
    return true;
  });
  compose::compose(a, b, {}, counting);
  EXPECT_EQ(last, 100);
  ASSERT_GT(calls, 5);
  for (int stop = 0; stop < calls; ++stop) {
    int call = 0;
    Progress progress([&](int, const char*) { return call++ < stop; });
    EXPECT_THROW(compose::compose(a, b, {}, progress), Cancelled) << stop;
    EXPECT_EQ(call, stop + 1) << "went on after the user cancelled";
  }
}

TEST(Compose, AnEyeInsideTheHeadGoesWithIt) {
  // A loose component that no seam touches follows what is around it.
  auto [a, b] = two_spheres();
  const int faces_a = a.mesh.face_count(), faces_b = b.mesh.face_count();
  a.mesh = together({a.mesh, sphere({-0.5, 0, 0}, 0.2, 1), sphere({0.75, 0, 0}, 0.1, 1)});
  b.mesh = together({b.mesh, sphere({1.5, 0, 0}, 0.2, 1)});
  a.keep.resize(a.mesh.faces.size(), 0), b.keep.resize(b.mesh.faces.size(), 0);
  const compose::ComposeResult r = compose_quietly(a, b);
  expect_closed_manifold(r.composed, "eyes");
  const std::set<FaceKey> result = face_keys(r.composed);
  for (int f = faces_a; f < faces_a + 80; ++f) EXPECT_TRUE(result.count(face_key(a.mesh, f)));
  for (int f = faces_b; f < faces_b + 80; ++f) EXPECT_TRUE(result.count(face_key(b.mesh, f)));
  EXPECT_EQ(mesh::check(r.composed).components, 3);  // A's second ball lies where B is kept
}

}  // namespace
}  // namespace parts::test
