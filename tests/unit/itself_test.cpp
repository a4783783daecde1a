// SPDX-License-Identifier: GPL-3.0-or-later
// Scans mended without a database, from themselves.
#include <gtest/gtest.h>

#include "mend_support.h"
#include "parts/align/symmetry.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

/// An egg with bumps and dents: in pairs, mirrored in x, or each by itself.
Mesh bumpy(unsigned seed, bool symmetric, const Vec3& bump = Vec3(0.8, 0.3, 0.5)) {
  Random random(seed);
  struct Bump {
    Vec3 at;
    double height, width;
  };
  std::vector<Bump> bumps{{bump.normalized(), 0.25, 40}};
  for (int i = 0; i < 12; ++i) bumps.push_back({random.direction(), random.uniform(-0.12, 0.2), random.uniform(8, 30)});
  if (symmetric)
    for (std::size_t i = 0, n = bumps.size(); i < n; ++i) bumps.push_back(bumps[i]), bumps.back().at.x() *= -1;
  Mesh mesh = sphere(Vec3::Zero(), 1, 4);
  for (Vec3& p : mesh.vertices) {
    double r = 1;
    for (const Bump& b : bumps) r += b.height * std::exp(b.width * (p.dot(b.at) - 1));
    p = r * p.cwiseProduct(Vec3(0.8, 1.2, 1));
  }
  return mesh;
}

Eigen::Affine3d random_place(Random& random, double& scale) {
  scale = std::pow(10.0, random.uniform(-2, 2));
  Eigen::Affine3d place = Eigen::Affine3d::Identity();
  place.linear() = scale * random.rotation();
  place.translation() = 5 * scale * random.direction();
  return place;
}

/// Without what lies near the first bump, and where that was.
struct Holed {
  Mesh whole, scan;
  std::vector<Vec3> lost;
  double scale = 1;
};
Holed holed(unsigned seed, bool symmetric, const Vec3& bump, double radius = 0.4) {
  Random random(1000 + seed);
  Holed h;
  const Eigen::Affine3d place = random_place(random, h.scale);
  h.whole = bumpy(seed, symmetric, bump);
  const Vec3 at = spatial::ClosestFace(h.whole)(1.2 * bump.normalized().cwiseProduct(Vec3(0.8, 1.2, 1))).point;
  std::vector<char> stays;
  for (int f = 0; f < h.whole.face_count(); ++f) stays.push_back((h.whole.center(f) - at).norm() > radius);
  h.whole = moved(h.whole, place);
  h.scan = mesh::take_faces(h.whole, stays);
  h.lost = within(h.whole, place * at, 0.95 * radius * h.scale);
  return h;
}

mend::Mended fill_from_itself(const Mesh& scan, std::vector<std::string>* lines = nullptr) {
  mend::MendOptions options;
  options.fill = true;
  options.region = around_holes();
  Progress progress({}, [&](const std::string& line) {
    if (lines) lines->push_back(line);
  });
  return mend::mend_scan(scan, nullptr, options, progress);
}

TEST(Symmetry, PlaneIsFoundWhereverTheShapeLies) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    Random random(seed);
    double scale;
    const Eigen::Affine3d place = random_place(random, scale);
    Mesh mesh = moved(bumpy(seed, true), place);
    if (seed % 2) mesh = without_ball(mesh, place * Vec3(0.7, 0.3, 0.5), 0.5 * scale);  // with a hole on one side
    Progress silent;
    const auto planes = align::find_symmetries(mesh, {}, 3, 0, silent);
    ASSERT_FALSE(planes.empty());
    const Vec3 normal = (place.linear() * Vec3::UnitX()).normalized();
    EXPECT_GT(std::abs(planes[0].normal.dot(normal)), std::cos(0.02)) << seed;
    EXPECT_LT(planes[0].distance(place.translation()), 0.02 * scale) << seed;
    EXPECT_TRUE(planes[0].holds());
    EXPECT_LT(planes[0].residual, 0.01 * planes[0].size) << seed;
  }
}

TEST(Symmetry, IsNotHeldOfShapesThatHaveNone) {
  Progress silent;
  for (unsigned seed = 0; seed < 4; ++seed) {
    const auto planes = align::find_symmetries(noisy_sphere(Vec3::Zero(), 1, 4, 0.3, seed), {}, 1, 0, silent);
    const auto fair = align::find_symmetries(bumpy(seed, true), {}, 1, 0, silent);
    EXPECT_GT(planes.at(0).residual / planes[0].size, 3 * fair.at(0).residual / fair[0].size) << seed;
  }
}

TEST(Itself, ABumpComesBackFromTheOtherSide) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Holed h = holed(seed, true, Vec3(0.8, 0.3, 0.5));
    std::vector<std::string> lines;
    const mend::Mended m = fill_from_itself(h.scan, &lines);
    expect_closed_manifold(m.mesh, "seed " + std::to_string(seed));
    EXPECT_LT(rms(h.lost, m.mesh), 0.01 * h.scale) << seed;  // the bump is 0.25 high
    EXPECT_EQ(missing(h.scan, m.mesh, [](int) { return true; }), 0);
    EXPECT_TRUE(std::any_of(lines.begin(), lines.end(),
                            [](const std::string& l) { return l.rfind("symmetry_residual: ", 0) == 0; }));
  }
}

TEST(Itself, WhatIsNotForetoldIsRefusedOrSmooth) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Holed h = holed(seed, false, Vec3(0.8, 0.3, 0.5));
    try {
      const mend::Mended m = fill_from_itself(h.scan);
      expect_closed_manifold(m.mesh, "seed " + std::to_string(seed));
      EXPECT_LT(rms(h.lost, m.mesh), 0.08 * h.scale) << seed;  // no worse than without the bump, which is 0.25 high
    } catch (const UserError& e) {
      EXPECT_NE(std::string(e.what()).find("mirror image"), std::string::npos) << e.what();
    }
  }
}

TEST(Itself, AHoleInThePlaneIsNotFilledFromItself) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Holed h = holed(seed, true, Vec3(0, 0.3, 0.8));
    try {
      const mend::Mended m = fill_from_itself(h.scan);
      expect_closed_manifold(m.mesh, "seed " + std::to_string(seed));
      EXPECT_LT(rms(h.lost, m.mesh), 0.08 * h.scale) << seed;
    } catch (const UserError& e) {
      EXPECT_NE(std::string(e.what()).find("Database"), std::string::npos) << e.what();
    }
  }
}

TEST(Itself, AFlawIsRestoredFromTheOtherSide) {
  Holed h = holed(3, true, Vec3(0.8, 0.3, 0.5));
  std::vector<Vec3> center{Vec3::Zero()};
  for (const Vec3& p : h.lost) center[0] += p / double(h.lost.size());
  std::vector<char> flawed;
  Mesh scan = gouged(h.whole, center[0], 0.3 * h.scale, 0.15 * h.scale, 5, &flawed);
  scan.face_selected = flawed;
  mend::MendOptions options;
  Progress silent;
  const double damage = rms(within(h.whole, center[0], 0.3 * h.scale), scan);
  const mend::Mended m = mend::mend_scan(scan, nullptr, options, silent);
  expect_closed_manifold(m.mesh, "restored");
  EXPECT_LT(rms(within(h.whole, center[0], 0.3 * h.scale), m.mesh), 0.3 * damage);
}

TEST(Itself, SimilarPlaceElsewhere) {
  // A plate with equal bosses scattered over it, of which half of one is lost.
  const auto height = [](double x, double y) {
    double z = 0.005 * std::sin(1.3 * x + 0.4) * std::cos(0.9 * y);
    for (const auto& [cx, cy] : {std::pair(-1.5, -0.4), {-0.5, 0.5}, {0.3, -0.1}, {1.4, 0.4}, {1.1, -0.6}})
      z += 0.3 * std::exp(-12 * (std::pow(x - cx, 2) + std::pow(y - cy, 2)));
    return z;
  };
  Mesh plate = box(Vec3(-2, -1, -0.5), Vec3(2, 1, 0), 60);
  for (Vec3& p : plate.vertices)
    if (p.z() > -0.01) p.z() += height(p.x(), p.y());
  const Vec3 at(-0.4, 0.5, 0.25);
  const Mesh scan = without_ball(plate, at, 0.22);
  const mend::Mended m = fill_from_itself(scan);
  expect_closed_manifold(m.mesh, "plate");
  EXPECT_NE(m.candidates.at(0).name.find("place"), std::string::npos) << m.candidates[0].name;
  EXPECT_LT(rms(within(plate, at, 0.2), m.mesh), 0.01);
}

TEST(Mend, ALabsOwnScansAreADatabase) {
  // Noisy, open at the neck, coarser and finer, in millimetres and metres, Z up.
  const NoseHole n;
  std::vector<Mesh> scans;
  for (unsigned i = 0; i < 5; ++i) {
    Random random(i);
    Mesh scan = bust_mesh(random_bust(20 + i), "", i % 2 ? 32 : 44);
    std::vector<char> above;
    for (int f = 0; f < scan.face_count(); ++f) above.push_back(scan.center(f).y() > -0.5);
    scan = mesh::take_faces(scan, above);
    for (Vec3& p : scan.vertices) {
      p += 0.002 * random.direction();
      p = (i % 2 ? 250 : 0.25) * Vec3(p.x(), -p.z(), p.y());  // a head of 25 cm
    }
    scans.push_back(std::move(scan));
  }
  Mesh scan = n.scan;
  for (Vec3& p : scan.vertices) p *= 250;
  const mend::Mended m = fill_all(scan, scans);
  ASSERT_EQ(m.count(mend::RegionReport::End::Mended), 1);
  expect_closed_manifold(m.mesh, "bust");
  std::vector<Vec3> lost = within(n.whole, n.tip, 0.15);
  const double rim = rms(lost, n.scan) * 250;
  for (Vec3& p : lost) p *= 250;
  EXPECT_LT(rms(lost, m.mesh), 0.4 * rim);
}

}  // namespace
}  // namespace parts::test
