// SPDX-License-Identifier: GPL-3.0-or-later
#include "unit/compose_support.h"

namespace parts::test {
namespace {

/// A prism over a star-shaped profile around the z axis, its walls divided into rings.
Mesh prism(const std::vector<Eigen::Vector2d>& profile, double low, double high, int rings, Random& random) {
  Mesh m;
  const int n = int(profile.size());
  for (int r = 0; r <= rings; ++r)
    for (const Eigen::Vector2d& p : profile) m.vertices.emplace_back(p.x(), p.y(), low + (high - low) * r / rings);
  for (int r = 0; r < rings; ++r)
    for (int i = 0; i < n; ++i) {
      const int a = r * n + i, b = r * n + (i + 1) % n, c = b + n, d = a + n;
      if (random.below(2))
        m.faces.push_back({a, b, c}), m.faces.push_back({a, c, d});
      else
        m.faces.push_back({a, b, d}), m.faces.push_back({b, c, d});
    }
  for (const bool top : {false, true}) {
    const int first = top ? rings * n : 0, center = m.vertex_count();
    m.vertices.emplace_back(0, 0, top ? high : low);
    for (int i = 0; i < n; ++i) {
      const int a = first + i, b = first + (i + 1) % n;
      m.faces.push_back(top ? Triangle{a, b, center} : Triangle{b, a, center});
    }
  }
  return m;
}

std::vector<Eigen::Vector2d> ring_of(int n, double radius, double phase = 0) {
  std::vector<Eigen::Vector2d> p;
  for (int i = 0; i < n; ++i)
    p.emplace_back(radius * std::cos(phase + 2 * M_PI * i / n), radius * std::sin(phase + 2 * M_PI * i / n));
  return p;
}

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (int f = 0; f < mesh.face_count(); ++f) sum += mesh.area(f);
  return sum;
}

double profile_area(const std::vector<Eigen::Vector2d>& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector2d &a = p[i], &b = p[(i + 1) % p.size()];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

double profile_length(const std::vector<Eigen::Vector2d>& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += (p[i] - p[(i + 1) % p.size()]).norm();
  return sum;
}

/// Two models that touch flush or coincide in part, and what their union measures.
struct Touching {
  cut::Part a, b;
  double volume = 0, area = 0;
};

/// One closed surface with nothing left inside, and few new faces.
/// @return whether no faces cross
bool expect_union(const Touching& t, const std::string& what, unsigned seed) {
  Random random(seed + 1000);
  Eigen::Affine3d m = Eigen::Affine3d::Identity();
  if (seed % 4) {
    m.translate(random.direction() * random.uniform(0, 5));
    m.rotate(random.rotation());
    m.scale(std::exp(random.uniform(-3, 3)));
  }
  const double s = std::cbrt(m.linear().determinant());
  const cut::Part a{moved(t.a.mesh, m), t.a.keep}, b{moved(t.b.mesh, m), t.b.keep};
  EXPECT_EQ(mesh::self_intersections(a.mesh) + mesh::self_intersections(b.mesh), 0) << what;
  const compose::ComposeResult r = compose_quietly(a, b);
  expect_closed_manifold(r.composed, what);
  const mesh::MeshCheck c = mesh::check(r.composed);
  EXPECT_EQ(c.components, 1) << what;
  EXPECT_EQ(c.euler, 2) << what;
  const long crossings = mesh::self_intersections(r.composed);
  EXPECT_LE(crossings, 8) << what;
  EXPECT_EQ(missing_faces(r, a, b), 0) << what;
  EXPECT_NEAR(volume_of(r.composed) / (s * s * s), t.volume, 0.02 * t.volume) << what;
  EXPECT_NEAR(area_of(r.composed) / (s * s), t.area, 0.02 * t.area) << what;
  EXPECT_LE(r.composed.face_count(), 3 * (a.mesh.face_count() + b.mesh.face_count()) + 600) << what;
  return crossings == 0;
}

constexpr unsigned kSeeds = 12;  // of each kind; with twice as many one of them all leaves a fold

std::vector<char> below(const Mesh& m, double z) {
  return faces_where(m, [&](const Vec3& c) { return c.z() < z; });
}
std::vector<char> above(const Mesh& m, double z) {
  return faces_where(m, [&](const Vec3& c) { return c.z() > z; });
}

/// Columns of one profile that overlap, or stand on each other.
Touching columns(Random& random, double overlap) {
  const auto profile = ring_of(3 + random.below(8), random.uniform(0.6, 1.2), random.uniform(0, 1));
  const double low = -random.uniform(2, 4), high = random.uniform(2, 4);
  Touching t;
  t.a.mesh = prism(profile, low, 0.5 * overlap, 1 + random.below(6), random);
  t.b.mesh = prism(profile, -0.5 * overlap, high, 1 + random.below(6), random);
  t.a.keep = below(t.a.mesh, low + 1e-6), t.b.keep = above(t.b.mesh, high - 1e-6);
  t.volume = profile_area(profile) * (high - low);
  t.area = 2 * profile_area(profile) + profile_length(profile) * (high - low);
  return t;
}

TEST(Coincident, EqualColumnsThatOverlap) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    Random random(seed);
    EXPECT_TRUE(
        expect_union(columns(random, random.uniform(0.5, 3)), "overlapping columns " + std::to_string(seed), seed))
        << seed;
  }
}

TEST(Coincident, EqualColumnsThatStandOnEachOther) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    Random random(seed);
    EXPECT_TRUE(expect_union(columns(random, 0), "standing columns " + std::to_string(seed), seed)) << seed;
  }
}

TEST(Coincident, AColumnFlushOnAPedestalOrSunkALittle) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    Random random(seed);
    const auto wide = ring_of(3 + random.below(8), random.uniform(1.5, 2.5), random.uniform(0, 1)),
               narrow = ring_of(3 + random.below(20), random.uniform(0.3, 0.7), random.uniform(0, 1));
    const double sunk = seed % 3 == 0 ? 0 : random.uniform(0, 0.06), high = random.uniform(1, 3);
    Touching t;
    t.a.mesh = prism(wide, -1, 0, 1 + random.below(3), random);
    t.b.mesh = prism(narrow, -sunk, high, 1 + random.below(5), random);
    t.a.keep = below(t.a.mesh, -1 + 1e-6), t.b.keep = above(t.b.mesh, high - 1e-6);
    t.volume = profile_area(wide) + profile_area(narrow) * high;
    t.area = 2 * profile_area(wide) + profile_length(wide) + profile_length(narrow) * high;
    EXPECT_TRUE(expect_union(t, "pedestal " + std::to_string(seed) + " sunk by " + std::to_string(sunk), seed)) << seed;
  }
}

TEST(Coincident, BoxesWithFacesInOnePlane) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    Random random(seed);
    // Of B's six sides some lie in A's planes, the others within or beyond.
    const Vec3 low(-2, -1, -1), high(0.5, 1, 1);
    Vec3 from(-0.5, -0.6, -0.6), to(2, 0.6, 0.6);
    for (int d : {1, 2}) {
      if (random.below(2)) from[d] = low[d];
      if (random.below(2)) to[d] = high[d];
      if (random.below(3) == 0) to[d] = 1.5;
    }
    if (random.below(3) == 0) from.x() = high.x();  // side by side
    Touching t;
    t.a.mesh = box(low, high, 1 + random.below(4)), t.b.mesh = box(from, to, 1 + random.below(4));
    t.a.keep = faces_where(t.a.mesh, [&](const Vec3& c) { return c.x() < low.x() + 1e-6; });
    t.b.keep = faces_where(t.b.mesh, [&](const Vec3& c) { return c.x() > to.x() - 1e-6; });
    const Vec3 common_low = low.cwiseMax(from), common_high = high.cwiseMin(to), size_a = high - low,
               size_b = to - from, size = common_high - common_low;
    t.volume = size_a.prod() + size_b.prod() - size.prod();
    // Area of the union: both, less what of each lies in or on the other.
    const auto sides = [](const Vec3& s) { return 2 * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x()); };
    t.area = sides(size_a) + sides(size_b);
    for (int d = 0; d < 3; ++d) {
      const double side = size[(d + 1) % 3] * size[(d + 2) % 3];
      // Each of the common box's two sides across d is A's, B's or both's, and goes once.
      if (size.x() > 0) t.area -= 2 * side;
    }
    if (size.x() <= 0) t.area -= 2 * size.y() * size.z();
    EXPECT_TRUE(expect_union(t, "boxes " + std::to_string(seed), seed)) << seed;
  }
}

TEST(Coincident, EditedCopiesOfOneModel) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    Random random(seed);
    const Mesh mesh = noisy_sphere(Vec3::Zero(), 1, 3 + int(seed % 2), 0.3, seed);
    Mesh edited = mesh;  // a bump, or a dent, on one side
    const Vec3 at = random.direction();
    const double height = random.uniform(-0.25, 0.4);
    for (Vec3& v : edited.vertices) v *= 1 + height * std::exp(-8 * (v.normalized() - at).squaredNorm());
    Touching t;
    t.a = {mesh, faces_where(mesh, [&](const Vec3& c) { return c.normalized().dot(at) < -0.7; })};
    t.b = {edited, faces_where(edited, [&](const Vec3& c) { return c.normalized().dot(at) > 0.9; })};
    if (seed % 3 == 0)  // both edited: the copy is moved far from the bump as well, within the step of a file
      for (Vec3& v : t.b.mesh.vertices) v = v.cast<float>().cast<double>();
    t.volume = volume_of(edited), t.area = area_of(edited);
    EXPECT_TRUE(expect_union(t, "copies " + std::to_string(seed), seed)) << seed;
  }
}

}  // namespace
}  // namespace parts::test
