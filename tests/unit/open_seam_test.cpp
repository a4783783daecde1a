// SPDX-License-Identifier: GPL-3.0-or-later
// Open models at the seam: their own borders, chains of what was cut, pinholes, flaps.
#include "unit/seam_support.h"

namespace parts::test {
namespace {

using Value = std::function<double(const Vec3&)>;

double bumps(double x, double y) { return 0.15 * std::sin(2.1 * x + 0.3) * std::cos(1.7 * y); }

Mesh sheet(int n, double from, double to, double half_width = 1, double lift = 0) {
  return patch(n, n, false, [=](double u, double v) {
    const double x = from + u * (to - from), y = half_width * (2 * v - 1);
    return Vec3(x, y, bumps(x, y) + lift);
  });
}

Value beyond(const Vec3& normal, double at, double waves = 0) {
  return [=](const Vec3& p) { return p.dot(normal) - at + waves * std::sin(9 * p.x() + 7 * p.y() + 5 * p.z()); };
}

TEST(OpenSeam, TwoHalfScansBecomeOneSurfaceWithOneBorder) {
  for (const double wider : {1.0, 1.003, 1.02, 1.08, 0.95})
    for (const int finer : {24, 33, 50})
      for (const double gap : {0.01, 0.05}) {
        const std::string what = std::to_string(wider) + ", " + std::to_string(finer) + ", " + std::to_string(gap);
        const cut::Model a = model_of(sheet(24, -2, 0.5)), b = model_of(sheet(finer, -0.5, 2, wider, 0.01));
        const Stitched s =
            stitched(a, clip_by(a, beyond({-1, 0, 0}, gap)), b, clip_by(b, beyond({1, 0, 0}, gap)), 0.3, 0.08);
        const mesh::MeshCheck c = welded_check(s.mesh());
        EXPECT_TRUE(c.manifold() && c.oriented()) << what << "\n" << mesh::to_string(c);
        EXPECT_EQ(c.boundary_loops, 1) << what;
        EXPECT_EQ(c.components, 1) << what;
        EXPECT_EQ(c.euler, 1) << what;
        EXPECT_EQ(s.report.loops_open + s.report.loops_capped, 0) << what;
        EXPECT_EQ(mesh::self_intersections(s.mesh()), 0) << what;
        EXPECT_NEAR(s.report.seam_length, 2, 0.2) << what;
      }
}

/// The same surface, sampled by two scans.
struct Sampled {
  const char* name;
  Mesh a, b;
};

std::vector<Sampled> surfaces(Random& random) {
  const auto tube_of = [](int n, int m) {
    return patch(n, m, true, [](double u, double v) {
      const double r = 0.6 + 0.1 * std::sin(4 * v), w = 2 * M_PI * u;
      return Vec3(r * std::cos(w), r * std::sin(w), 3 * v - 1.5);
    });
  };
  const auto bowl = [](int n) {
    return without(sphere(Vec3::Zero(), 1, n), [](const Vec3& c) { return c.z() > 0.55; });
  };
  // Round holes, apart from each other, that both scans have.
  std::vector<Vec3> holes;
  while (holes.size() < 3) {
    const Vec3 h(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), 0);
    if (std::all_of(holes.begin(), holes.end(), [&](const Vec3& g) { return (g - h).norm() > 0.5; }))
      holes.push_back(h);
  }
  const auto pierced = [=](int n) {
    return clip_by(model_of(sheet(n, -1, 1)),
                   [=](const Vec3& p) {
                     double least = 1;
                     for (const Vec3& h : holes) least = std::min(least, (p - h).head<2>().norm() - 0.14);
                     return least;
                   })
        .mesh;
  };
  return {{"sheet", sheet(26, -1, 1), sheet(31, -1, 1)},
          {"tube", tube_of(36, 30), tube_of(41, 26)},
          {"bowl", bowl(4), moved(bowl(4), Eigen::Affine3d(Eigen::AngleAxisd(0.3, Vec3::UnitZ())))},
          {"pierced", pierced(40), pierced(47)},
          {"torus", torus(), torus(Vec3::Zero(), 1, 0.35, 55, 20)},
          {"ball", sphere(Vec3::Zero(), 1, 3), noisy_sphere(Vec3::Zero(), 1, 3, 0.01, 4)}};
}

TEST(OpenSeam, ASurfaceCutAnywhereAndStitchedIsTheSurface) {
  Random random(11);
  int runs = 0, same = 0;
  std::string differ;
  for (int trial = 0; trial < 25; ++trial)
    for (const Sampled& s : surfaces(random)) {
      const Vec3 normal = random.direction();
      const double at = random.uniform(-0.4, 0.4), gap = random.uniform(0, 0.04), waves = trial % 3 ? 0.0 : 0.03;
      const cut::Model a = model_of(s.a), b = model_of(s.b);
      const seam::Clipped ca = clip_by(a, beyond(normal, at + gap, waves), 0.1),
                          cb = clip_by(b, beyond(-normal, -at + gap, -waves), 0.1);
      if (ca.border.empty() || cb.border.empty()) continue;
      const Stitched r = stitched(a, ca, b, cb, 0.3, 0.06);
      const std::string what = std::string(s.name) + " " + std::to_string(trial);
      const mesh::MeshCheck c = welded_check(r.mesh()), whole = mesh::check(s.a);
      EXPECT_TRUE(c.manifold() && c.oriented()) << what << "\n" << mesh::to_string(c);
      const bool as_before = c.boundary_loops == whole.boundary_loops && c.components == 1 && c.euler == whole.euler;
      ++runs, same += as_before;
      if (!as_before) differ += what + "\n" + mesh::to_string(c);
    }
  EXPECT_GE(runs, 120);
  // A cut may touch a hole of one scan and miss it in the other's.
  EXPECT_LE(runs - same, 1) << differ;
}

TEST(OpenSeam, AScanLaidOnAClosedSurfaceIsJoinedAtItsOwnBorder) {
  for (const int n : {3, 4}) {
    const Mesh scan = without(sphere(Vec3::Zero(), 1.02, 4), [](const Vec3& c) { return c.z() < 0.6; });
    const cut::Model a = model_of(scan), b = model_of(sphere(Vec3::Zero(), 1, n));
    const seam::Clipped whole = clip_by(a, [](const Vec3&) { return 1.0; });
    const Stitched s = stitched(a, whole, b, clip_by(b, beyond({0, 0, -1}, -0.5, 0.02), 0.1), 0.3, 0.1);
    const mesh::MeshCheck c = welded_check(s.mesh());
    EXPECT_TRUE(c.manifold() && c.oriented() && c.closed()) << mesh::to_string(c);
    EXPECT_EQ(c.components, 1);
    EXPECT_EQ(c.euler, 2);
    EXPECT_EQ(s.report.loops_open + s.report.loops_capped, 0);
  }
}

TEST(OpenSeam, AnInputsOwnBorderIsNoneOfOurs) {
  // A tube open at both ends, and a ball that a hole of its own has: all three stay.
  const cut::Model a = model_of(patch(40, 40, true,
                                      [](double u, double v) {
                                        return Vec3(0.5 * std::cos(2 * M_PI * u), 0.5 * std::sin(2 * M_PI * u), 2 * v);
                                      })),
                   b = model_of(without(sphere(Vec3::Zero(), 1, 4), [](const Vec3&c) { return c.z() < -0.8; }));
  const Stitched s =
      stitched(a, clip_by(a, beyond({0, 0, 1}, 0.95)), b, clip_by(b, beyond({0, 0, -1}, -0.85)), 0.3, 0.05);
  const mesh::MeshCheck c = welded_check(s.mesh());
  EXPECT_TRUE(c.manifold() && c.oriented()) << mesh::to_string(c);
  EXPECT_EQ(c.boundary_loops, 2);
  EXPECT_EQ(c.components, 1);
  EXPECT_EQ(s.report.loops_joined, 1);
  EXPECT_EQ(s.report.loops_open + s.report.loops_capped, 0);
}

TEST(OpenSeam, TinyLoopsAreCappedWhateverIsOpenElsewhere) {
  const cut::Model a = model_of(sheet(24, -2, 0.5)), b = model_of(sheet(30, -0.5, 2));
  const Vec3 spot(-1, 0.2, bumps(-1, 0.2));
  const auto side = beyond({-1, 0, 0}, 0.02);
  const Value pitted = [=](const Vec3& p) { return std::min(side(p), (p - spot).norm() - 0.07); };
  const Stitched s = stitched(a, clip_by(a, pitted, 0.03), b, clip_by(b, beyond({1, 0, 0}, 0.02)), 0.3, 0.08);
  const mesh::MeshCheck c = welded_check(s.mesh());
  EXPECT_TRUE(c.manifold() && c.oriented()) << mesh::to_string(c);
  EXPECT_EQ(c.boundary_loops, 1);
  EXPECT_EQ(s.report.loops_capped, 1);
  EXPECT_EQ(s.report.loops_open, 0);
}

TEST(OpenSeam, NoLooseFlapIsLeftAndNothingKeptIsLost) {
  cut::Model a = model_of(sheet(40, -2, 0.5)), b = model_of(sheet(37, -0.5, 2));
  const auto side = beyond({-1, 0, 0}, 0.02);
  // Beside the half, a corner of the sheet that the cut severed from it.
  const Value flapping = [=](const Vec3& p) { return std::max(side(p), 0.25 - (p - Vec3(0.5, 1, 0)).norm()); };
  const seam::Clipped cb = clip_by(b, beyond({1, 0, 0}, 0.02));
  const Stitched s = stitched(a, clip_by(a, flapping), b, cb, 0.1, 0.05);
  EXPECT_EQ(s.report.pieces_dropped, 1);
  EXPECT_EQ(welded_check(s.mesh()).components, 1);
  EXPECT_EQ(welded_check(s.mesh()).boundary_loops, 1);
  for (int f = 0; f < a.prepared.mesh.face_count(); ++f)
    a.keep[f] = (a.prepared.mesh.center(f) - Vec3(0.5, 1, 0)).norm() < 0.1;
  const Stitched kept = stitched(a, clip_by(a, flapping), b, cb, 0.1, 0.05);
  EXPECT_EQ(kept.report.pieces_dropped, 0);
  EXPECT_EQ(kept.report.loops_open, 1);
  EXPECT_EQ(welded_check(kept.mesh()).components, 2);
}

TEST(OpenSeam, TheOtherHalfIsTurnedOverWhereItFacesTheOtherWay) {
  Mesh turned = sheet(30, -0.5, 2);
  for (Triangle& f : turned.faces) std::swap(f[1], f[2]);
  const cut::Model a = model_of(sheet(24, -2, 0.5)), b = model_of(turned);
  const Stitched s =
      stitched(a, clip_by(a, beyond({-1, 0, 0}, 0.02)), b, clip_by(b, beyond({1, 0, 0}, 0.02)), 0.3, 0.08);
  EXPECT_TRUE(s.report.reversed_b);
  const mesh::MeshCheck c = welded_check(s.mesh());
  EXPECT_TRUE(c.manifold() && c.oriented()) << mesh::to_string(c);
  EXPECT_EQ(c.boundary_loops, 1);
  // A closed model is not: the cut's direction says less than its inside.
  const cut::Model whole = model_of(sphere());
  EXPECT_FALSE(
      seam::join_parts(whole, clip_by(whole, beyond({1, 0, 0}, 0.02)), whole, clip_by(whole, beyond({-1, 0, 0}, 0.02)))
          .may_turn_b);
}

}  // namespace
}  // namespace parts::test
