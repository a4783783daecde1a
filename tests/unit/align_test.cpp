// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/align/align.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "parts/base/error.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

using Eigen::Affine3d;

align::AlignResult align(const Mesh& moving, const Mesh& fixed, const align::AlignOptions& options = {},
                         const std::vector<char>& moving_part = {}, const std::vector<char>& fixed_part = {}) {
  Progress silent;
  return align::align_part_in_whole(moving, moving_part, fixed, fixed_part, options, silent);
}

/// Somewhere else: any rotation, and further away than the shape is large.
Affine3d anywhere(Random& random, double reach) {
  Affine3d t = Affine3d::Identity();
  t.linear() = random.rotation();
  t.translation() = reach * random.uniform(0, 2) * random.direction();
  return t;
}

double size_of(const Mesh& mesh) { return mesh.bounds().diagonal().norm(); }

/// How far the result leaves the vertices, moved by `away` before, from where
/// they were; RMS, as a share of the shape's size.
double error(const align::AlignResult& result, const Affine3d& away, const Mesh& mesh) {
  double sum = 0;
  for (const Vec3& v : mesh.vertices) sum += (Affine3d(result.matrix) * (away * v) - v).squaredNorm();
  return std::sqrt(sum / mesh.vertex_count()) / size_of(mesh);
}

double degrees_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.transpose() * b)).angle() * 180 / M_PI;
}

/// An L with unequal arms and a step across, so that no rotation maps it to itself.
Mesh step_shape(int divisions) {
  return together({box({0, 0, 0}, {3, 1, 1}, divisions), box({0, 1, 0}, {1, 2.5, 0.6}, divisions)});
}

/// The same blob at any resolution.
Mesh blob(int subdivisions) {
  Mesh m = sphere(Vec3::Zero(), 1, subdivisions);
  for (Vec3& v : m.vertices) {
    const Vec3 d = v;
    v *= 1 + 0.35 * std::sin(2.3 * d[0] + 0.4) * std::cos(1.7 * d[1] + 0.6) + 0.25 * std::sin(3.1 * d[2] + d[0]);
    v[0] *= 1.4;
  }
  return m;
}

struct Shape {
  const char* name;
  Mesh mesh;
};
const std::vector<Shape>& shapes() {
  static const std::vector<Shape> all{
      {"blob", blob(4)}, {"step", step_shape(3)}, {"bust", bust(1)}, {"man", man(32)}, {"animal", animal(32)}};
  return all;
}

TEST(Align, FindsTheSameShapeFromAnyPlacement) {
  Random random(1);
  for (const Shape& s : shapes())
    for (int i = 0; i < 3; ++i) {
      const Affine3d away = anywhere(random, size_of(s.mesh));
      const align::AlignResult r = align(moved(s.mesh, away), s.mesh);
      EXPECT_LT(error(r, away, s.mesh), 1e-5) << s.name << i;
      EXPECT_LT(r.rms_after, 1e-5 * size_of(s.mesh)) << s.name << i;
      EXPECT_GT(r.rms_before, 100 * r.rms_after) << s.name << i;
      EXPECT_GT(r.inlier_share, 0.99) << s.name << i;
      EXPECT_GE(r.candidates, 24) << s.name << i;
    }
}

TEST(Align, TessellationDoesNotMatter) {
  Random random(2);
  const Mesh fine = blob(5), coarse = blob(3), cut = step_shape(9), whole = step_shape(1);
  const Affine3d away = anywhere(random, 3);
  EXPECT_LT(error(align(moved(fine, away), coarse), away, fine), 0.01);
  EXPECT_LT(error(align(moved(coarse, away), fine), away, coarse), 0.01);
  EXPECT_LT(error(align(moved(cut, away), whole), away, cut), 1e-4);
  EXPECT_LT(error(align(moved(whole, away), cut), away, whole), 1e-4);
}

TEST(Align, NoiseIsAveragedOut) {
  Random random(3);
  for (const Shape& s : shapes()) {
    Mesh noisy = s.mesh;
    for (Vec3& v : noisy.vertices) v += random.uniform(-0.005, 0.005) * size_of(s.mesh) * random.direction();
    const Affine3d away = anywhere(random, size_of(s.mesh));
    EXPECT_LT(error(align(moved(noisy, away), s.mesh), away, s.mesh), 0.003) << s.name;
  }
}

TEST(Align, FaceOrientationDoesNotMatter) {
  Random random(4);
  Mesh mixed = bust(1);
  for (int f = 0; f < mixed.face_count(); ++f)
    if (random.below(2)) std::swap(mixed.faces[f][0], mixed.faces[f][1]);
  const Affine3d away = anywhere(random, 2);
  EXPECT_LT(error(align(moved(mixed, away), bust(1)), away, mixed), 1e-5);
}

TEST(Align, ScalesOnlyWhereAllowed) {
  Random random(5);
  align::AlignOptions scale;
  scale.allow_scale = true;
  for (const Shape& s : {Shape{"blob", blob(3)}, Shape{"bust", bust(1)}})
    for (double factor : {0.01, 0.6, 30.0}) {
      Affine3d away = anywhere(random, size_of(s.mesh));
      away.linear() *= factor;
      const Mesh other = moved(s.mesh, away);
      EXPECT_LT(error(align(other, s.mesh, scale), away, s.mesh), 1e-5) << s.name << factor;
      const Eigen::Matrix3d linear = align(other, s.mesh).matrix.topLeftCorner<3, 3>();
      EXPECT_TRUE((linear.transpose() * linear).isIdentity(1e-12)) << s.name << factor;
    }
}

TEST(Align, MirrorsOnlyWhereAllowedAndNeeded) {
  Random random(6);
  align::AlignOptions mirror;
  mirror.allow_mirror = true;
  for (const Shape& s : {Shape{"blob", blob(4)}, Shape{"step", step_shape(3)}}) {
    Affine3d away = anywhere(random, 3);
    EXPECT_LT(error(align(moved(s.mesh, away), s.mesh, mirror), away, s.mesh), 1e-5) << s.name;
    away.linear().col(1) *= -1;
    const Mesh image = moved(s.mesh, away);
    EXPECT_LT(error(align(image, s.mesh, mirror), away, s.mesh), 1e-5) << s.name;
    EXPECT_NEAR(align(image, s.mesh).matrix.determinant(), 1, 1e-12) << s.name;
  }
  // A symmetric shape needs no mirror.
  const Mesh torso = man(32);
  EXPECT_NEAR(align(moved(torso, anywhere(random, 3)), torso, mirror).matrix.determinant(), 1, 1e-12);
}

TEST(Align, FindsAPartInTheWhole) {
  Random random(7);
  for (const Shape& s : shapes())
    for (double share : {0.6, 0.3}) {
      // Such a piece of a step or of a man (an arm) fits in several places.
      if ((std::string(s.name) == "step" || std::string(s.name) == "man") && share < 0.5) continue;
      const std::vector<char> part = share_along(s.mesh, random.direction(), share);
      const Affine3d away = anywhere(random, size_of(s.mesh));
      // The whole model moves with its part.
      EXPECT_LT(error(align(moved(s.mesh, away), s.mesh, {}, part), away, s.mesh), 1e-4) << s.name << share;
    }
}

TEST(Align, FindsWhereAnIncompleteModelBelongs) {
  Random random(8);
  align::AlignOptions options;
  options.overlap = 0.55;
  for (const Shape& s : shapes()) {
    const std::vector<char> rest = share_along(s.mesh, random.direction(), 0.6);
    const Affine3d away = anywhere(random, size_of(s.mesh));
    EXPECT_LT(error(align(moved(s.mesh, away), s.mesh, options, {}, rest), away, s.mesh), 1e-3) << s.name;
  }
}

TEST(Align, OtherBustFacesTheSameWay) {
  Random random(9);
  align::AlignOptions scale;
  scale.allow_scale = true;
  for (unsigned seed : {2u, 3u, 4u}) {
    const Affine3d away = anywhere(random, 2);
    const align::AlignResult r = align(moved(bust(seed), away), bust(1), scale);
    const Eigen::Matrix3d turned = (Affine3d(r.matrix) * away).rotation();
    EXPECT_LT(degrees_between(turned, Eigen::Matrix3d::Identity()), 10) << seed;
    EXPECT_LT(r.rms_after, r.rms_before / 2) << seed;
  }
}

TEST(Align, FarFromTheOriginAndTiny) {
  Random random(10);
  const Mesh shape = blob(3);
  for (double unit : {1e-6, 1e6}) {
    Affine3d small = Affine3d::Identity();
    small.linear() *= unit;
    const Mesh fixed = moved(shape, small);
    const Affine3d away = anywhere(random, 3 * unit);
    EXPECT_LT(error(align(moved(fixed, away), fixed), away, fixed), 1e-5) << unit;
  }
  Affine3d far = Affine3d::Identity();
  far.translation() = Vec3(1e6, -1e6, 1e6);
  const Mesh fixed = moved(shape, far);
  const align::AlignResult r = align(moved(fixed, Affine3d(Eigen::AngleAxisd(2, Vec3::UnitY()))), fixed);
  EXPECT_LT(error(r, Affine3d(Eigen::AngleAxisd(2, Vec3::UnitY())), fixed), 1e-5);
  EXPECT_NEAR(r.rms_before, 2.4e6, 1.2e6);
}

TEST(Align, SymmetricShapesMoveNoMoreThanNeeded) {
  Affine3d away = Affine3d(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()));
  away.translation() = Vec3(4, 1, 0);
  const align::AlignResult ball = align(moved(sphere(), away), sphere());
  EXPECT_LT(ball.rms_after, 1e-2);
  EXPECT_LT((Affine3d(ball.matrix) * Vec3(away.translation())).norm(), 1e-2);
  // Of a cuboid's four ways to fit, the one 0.3 radians from here.
  const Mesh cuboid = box({-3, -2, -1}, {3, 2, 1}, 4);
  EXPECT_LT(error(align(moved(cuboid, away), cuboid), away, cuboid), 1e-4);
}

TEST(Align, PlanarParts) {
  const Mesh small = box({0, 0, 0}, {1, 0.7, 0.5}), large = box({-5, -5, -2}, {5, 5, 0}, 6);
  const auto top = [](const Vec3& c) { return std::abs(c[2]) < 1e-9; };
  const std::vector<char> bottom = faces_where(small, top), table = faces_where(large, top);
  Affine3d away = Affine3d::Identity();
  away.translation()[2] = 0.25;
  const align::AlignResult r = align(moved(small, away), large, {}, bottom, table);
  EXPECT_NEAR(r.rms_before, 0.25, 1e-9);
  EXPECT_LT(r.rms_after, 1e-6);
  EXPECT_NEAR(r.matrix(2, 2) * 0.25 + r.matrix(2, 3), 0, 1e-6);
  EXPECT_TRUE(align(moved(small, Affine3d(Eigen::AngleAxisd(1, Vec3::UnitX()))), large, {}, bottom).matrix.allFinite());
}

TEST(Align, FewFaces) {
  Mesh one;
  one.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0.5, 0}};
  one.faces = {{0, 1, 2}};
  Random random(11);
  const Affine3d away = anywhere(random, 2);
  const align::AlignResult r = align(moved(one, away), one);
  EXPECT_LT(r.rms_after, 1e-4);
  EXPECT_LT(error(r, away, one), 0.01);
  EXPECT_TRUE(align(one, bust(1)).matrix.allFinite());
  EXPECT_TRUE(align(bust(1), one).matrix.allFinite());
}

TEST(Align, DamagedFacesAreIgnored) {
  Random random(12);
  Mesh damaged = blob(3);
  damaged.faces.push_back({5, 5, 9});
  damaged.faces.push_back({7, 7, 7});
  damaged.faces.push_back(damaged.faces[0]);
  const Affine3d away = anywhere(random, 3);
  EXPECT_LT(error(align(moved(damaged, away), blob(3)), away, blob(3)), 1e-3);
}

TEST(Align, RefinesWhereTheModelsAre) {
  align::AlignOptions here;
  here.coarse = false;
  Affine3d away = Affine3d(Eigen::AngleAxisd(0.15, Vec3(1, 2, 3).normalized()));
  away.translation() = Vec3(0.05, 0.02, -0.04);
  const Mesh shape = bust(1);
  const align::AlignResult r = align(moved(shape, away), shape, here);
  EXPECT_LT(error(r, away, shape), 1e-4);
  EXPECT_EQ(r.candidates, 1);
  here.max_iterations = 0;
  EXPECT_TRUE(align(moved(shape, away), shape, here).matrix.isIdentity(1e-12));
}

TEST(Align, NeverWorseThanBefore) {
  align::AlignOptions options;
  for (bool coarse : {true, false}) {
    options.coarse = coarse;
    const align::AlignResult r = align(man(32), animal(32), options);
    EXPECT_LE(r.rms_after, r.rms_before * 1.000001);
    const align::AlignResult still = align(bust(1), bust(1), options);
    EXPECT_TRUE(still.matrix.isIdentity(1e-6));
  }
}

/// What a scanner sees of a shape that stands at a yaw, with noise of a share of its size.
Mesh seen_from(const Mesh& shape, double yaw, double noise, Random& random) {
  const Vec3 at(std::sin(yaw), 0, std::cos(yaw));
  Mesh scan;
  std::vector<int> number(shape.vertices.size(), -1);
  for (int f = 0; f < shape.face_count(); ++f) {
    if (shape.normal(f).dot(at) < 0.25) continue;
    scan.faces.push_back(shape.faces[f]);
    for (int& v : scan.faces.back()) {
      if (number[v] < 0) {
        number[v] = scan.vertex_count();
        scan.vertices.push_back(shape.vertices[v] + noise * size_of(shape) * random.uniform(0, 1) * random.direction());
      }
      v = number[v];
    }
  }
  return scan;
}

TEST(Align, ScansThatShareLittleFindTheirPlaceOrItIsSaid) {
  Random random(21);
  align::AlignOptions options;
  options.less_overlap = true;
  int right = 0, silent = 0;
  constexpr int kCases = 10;
  for (int i = 0; i < kCases; ++i) {
    const Mesh shape = i % 2 ? blob(4) : bust(unsigned(i + 1), 40);
    const double yaw = random.uniform(-M_PI, M_PI), between = random.uniform(0.7, 1.4);  // they share about half
    const Mesh a = seen_from(shape, yaw, 0.001, random), b = seen_from(shape, yaw + between, 0.001, random);
    const Affine3d away = anywhere(random, size_of(shape));
    const align::AlignResult r = align(moved(a, away), b, options);
    const bool found = error(r, away, a) < 0.02;
    right += found;
    silent += !found && r.doubts.empty();
    EXPECT_TRUE(found || !r.doubts.empty()) << "case " << i << ": wrong and not a word, inliers " << r.inlier_share;
  }
  EXPECT_EQ(silent, 0);
  EXPECT_GE(right, kCases / 2);
  RecordProperty("right", right);
}

TEST(Align, DoubtsAWrongPlaceAndNotARightOne) {
  Random random(22);
  for (const Shape& s : shapes()) {
    Mesh noisy = s.mesh;
    for (Vec3& v : noisy.vertices) v += random.uniform(0, 0.001) * size_of(s.mesh) * random.direction();
    EXPECT_TRUE(align(moved(noisy, anywhere(random, 2)), s.mesh).doubts.empty()) << s.name;
  }
  const align::AlignResult wrong = align(man(32), blob(4));
  EXPECT_LT(wrong.inlier_share, 0.5);
  ASSERT_EQ(wrong.doubts.size(), 1u);
  EXPECT_NE(wrong.doubts[0].find("Only "), std::string::npos);
}

TEST(Align, SaysWhenTheSizesAreThoseOfOtherUnits) {
  Random random(23);
  const Mesh shape = bust(1);
  for (const double factor : {0.001, 1000.0}) {
    Affine3d away = anywhere(random, 2);
    away.linear() *= factor;
    const Mesh other = moved(shape, away);
    align::AlignOptions options;
    const std::vector<std::string> doubts = align(other, shape, options).doubts;
    ASSERT_FALSE(doubts.empty());
    EXPECT_NE(doubts[0].find(factor < 1 ? "about 1000 times as small" : "about 1000 times as large"), std::string::npos)
        << doubts[0];
    options.allow_scale = true;
    EXPECT_TRUE(align(other, shape, options).doubts.empty());
  }
  Affine3d twice = Affine3d::Identity();
  twice.linear() *= 2;
  for (const std::string& doubt : align(moved(shape, twice), shape).doubts)
    EXPECT_EQ(doubt.find("units"), std::string::npos) << doubt;
}

TEST(Align, TheNumberOfThreadsDoesNotMatter) {
  Random random(13);
  const Mesh shape = bust(1), other = moved(bust(2), anywhere(random, 2));
  align::AlignOptions options;
  options.allow_scale = options.allow_mirror = true;
  options.threads = 1;
  const align::AlignResult one = align(other, shape, options);
  for (int threads : {2, 8}) {
    options.threads = threads;
    const align::AlignResult r = align(other, shape, options);
    EXPECT_EQ(r.matrix, one.matrix) << threads;
    EXPECT_EQ(r.rms_after, one.rms_after) << threads;
    EXPECT_EQ(r.iterations, one.iterations) << threads;
  }
}

TEST(Align, ProgressRisesAndCancels) {
  const Mesh shape = bust(1);
  int calls = 0, last = 0;
  Progress watch([&](int percent, const char* stage) {
    EXPECT_GE(percent, last) << stage;
    last = percent;
    ++calls;
    return true;
  });
  align::AlignOptions less;
  for (const bool anew : {true, false}) {
    less.less_overlap = anew;
    last = 0;
    align::align_part_in_whole(man(32), {}, shape, {}, less, watch);
    EXPECT_EQ(last, 100);
  }
  ASSERT_GT(calls, 5);
  for (int stop = 1; stop <= 8; ++stop) {
    int left = stop;
    Progress cancel([&](int, const char*) { return --left > 0; });
    EXPECT_THROW(align::align_part_in_whole(man(32), {}, shape, {}, {}, cancel), Cancelled) << stop;
  }
}

TEST(Align, SaysWhatIsWrong) {
  const Mesh good = blob(2);
  EXPECT_THROW(align({}, good), UserError);
  EXPECT_THROW(align(good, {}), UserError);
  Mesh points = good;
  points.faces.clear();
  EXPECT_THROW(align(points, good), UserError);
  Mesh line;
  line.vertices = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {7, 7, 7}};
  line.faces = {{0, 1, 2}, {1, 2, 3}, {3, 3, 3}};
  EXPECT_THROW(align(line, good), UserError);
  EXPECT_THROW(align(good, moved(line, Affine3d(Eigen::AngleAxisd(1, Vec3::UnitX())))), UserError);
  Mesh point = good;
  for (Vec3& v : point.vertices) v = Vec3(1, 2, 3);
  EXPECT_THROW(align(point, good), UserError);
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Mesh broken = good;
    broken.vertices[broken.faces[0][0]][1] = bad;
    EXPECT_THROW(align(broken, good), UserError);
    EXPECT_THROW(align(good, broken), UserError);
    // Elsewhere on the model it does no harm.
    std::vector<char> part(good.faces.size(), 0);
    for (int f = 0; f < good.face_count(); ++f) {
      bool uses = false;
      for (int v : good.faces[f]) uses |= v == broken.faces[0][0];
      part[f] = !uses;
    }
    EXPECT_TRUE(align(broken, good, {}, part).matrix.allFinite());
  }
  align::AlignOptions options;
  for (double overlap : {0.0, -1.0, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    options.overlap = overlap;
    EXPECT_THROW(align(good, good, options), UserError) << overlap;
  }
}

}  // namespace
}  // namespace parts::test
