// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "parts/mesh/attributes.h"
#include "unit/compose_support.h"

namespace parts::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The sentence, which must begin and end as one.
std::string sentence_of(const cut::Part& a, const cut::Part& b, const compose::ComposeOptions& options = {}) {
  const std::string s = user_error([&] { compose_quietly(a, b, options); });
  EXPECT_FALSE(s.empty()) << "no UserError";
  if (!s.empty()) {
    EXPECT_TRUE(std::isupper(s.front())) << s;
    EXPECT_EQ(s.back(), '.') << s;
    EXPECT_TRUE(s.find(';') != std::string::npos || s.find("must") != std::string::npos) << "says no remedy: " << s;
  }
  return s;
}

bool has(const std::string& text, const char* word) { return text.find(word) != std::string::npos; }

TEST(ComposeErrors, ModelsWithoutFaces) {
  const auto [a, b] = two_spheres();
  EXPECT_TRUE(has(sentence_of({}, b), "no faces in"));
  cut::Part cloud;
  cloud.mesh.vertices = a.mesh.vertices;
  EXPECT_TRUE(has(sentence_of(a, cloud), "no faces in"));
  cut::Part none = a;
  for (Vec3& v : none.mesh.vertices) v.x() = std::nan("");
  EXPECT_TRUE(has(sentence_of(none, b), "no usable face"));
  cut::Part points = a;
  for (Vec3& v : points.mesh.vertices) v.setZero();
  EXPECT_TRUE(has(sentence_of(points, b), "no usable face"));
}

TEST(ComposeErrors, Constraints) {
  auto [a, b] = two_spheres();
  cut::Part nothing = a;
  nothing.keep.assign(a.keep.size(), 0);
  EXPECT_TRUE(has(sentence_of(nothing, b), "Nothing of"));
  nothing.keep.clear();
  EXPECT_TRUE(has(sentence_of(b, nothing), "Nothing of"));
  // All that is kept is unusable.
  cut::Part broken = a;
  broken.mesh.faces.push_back({0, 0, 1});
  broken.keep.assign(broken.mesh.faces.size(), 0);
  broken.keep.back() = 1;
  EXPECT_TRUE(has(sentence_of(broken, b), "no usable face"));
  // Both constraints in one place.
  cut::Part same = a;
  same.keep = a.keep;
  EXPECT_TRUE(has(sentence_of(a, same), "same place"));
  compose::ComposeOptions options;
  options.cut = cut::Cut::Thesis;
  EXPECT_TRUE(has(sentence_of(a, same, options), "same voxel"));
  options.resolution = 30;
  EXPECT_TRUE(has(sentence_of(a, same, options), "same voxel"));
}

TEST(ComposeErrors, Volumes) {
  const auto [a, b] = two_spheres();
  const auto with = [&, &a = a, &b = b](const Vec3& min, const Vec3& max) {
    compose::ComposeOptions options;
    options.volume.min() = min, options.volume.max() = max;
    return sentence_of(a, b, options);
  };
  EXPECT_TRUE(has(with({-1, -1, 0}, {2, 1, 0}), "no thickness"));
  EXPECT_TRUE(has(with({-1, -1, -1}, {2, 1, kInfinity}), "not finite"));
  EXPECT_TRUE(has(with({1.2, -1, -1}, {2, 1, 1}), "misses"));
  EXPECT_TRUE(has(with({5, 5, 5}, {6, 6, 6}), "misses"));
  EXPECT_TRUE(has(with({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}), "misses")) << "inside A, on no surface";
  EXPECT_TRUE(has(with({-0.5, -1, -1}, {2, 1, 1}), "outside the volume"));
}

TEST(ComposeErrors, Options) {
  const auto [a, b] = two_spheres();
  const auto with = [&, &a = a, &b = b](const std::function<void(compose::ComposeOptions&)>& set) {
    compose::ComposeOptions options;
    set(options);
    return sentence_of(a, b, options);
  };
  EXPECT_TRUE(has(with([](auto& o) { o.resolution = -1; }), "Resolution"));
  EXPECT_TRUE(has(with([](auto& o) { o.smoothing.iterations = -1; }), "SmoothIterations"));
  EXPECT_TRUE(has(with([](auto& o) { o.smoothing.weight = 1.5; }), "SmoothWeight"));
  EXPECT_TRUE(has(with([](auto& o) { o.smoothing.weight = std::nan(""); }), "SmoothWeight"));
  EXPECT_TRUE(has(with([](auto& o) { o.smoothing.distance = -1; }), "SmoothDistance"));
  EXPECT_TRUE(has(with([](auto& o) { o.smoothing.distance = kInfinity; }), "SmoothDistance"));
  for (const int resolution : {20000, 2000000, std::numeric_limits<int>::max()}) {
    const std::string s = with([&](auto& o) { o.resolution = resolution, o.cut = cut::Cut::Thesis; });
    EXPECT_TRUE(has(s, "GB of memory")) << s;
  }
}

TEST(ComposeErrors, ModelsThatDoNotTouch) {
  auto [a, b] = two_spheres();
  b.mesh = moved(b.mesh, Eigen::Affine3d(Eigen::Translation3d(3, 0, 0)));
  EXPECT_TRUE(has(sentence_of(a, b), "do not touch"));
  compose::ComposeOptions options;
  options.resolution = 40;
  EXPECT_TRUE(has(sentence_of(a, b, options), "do not touch"));
  const cut::Part inner{sphere(Vec3::Zero(), 0.3, 2), std::vector<char>(320, 1)};
  EXPECT_TRUE(has(sentence_of(a, inner), "do not touch")) << "one inside the other";
}

TEST(ComposeNasty, SoupWithRepeatsSliversAndNaN) {
  // The same two spheres as a careless exporter would write them.
  const auto [a, b] = two_spheres();
  const auto spoiled = [](const cut::Part& p) {
    cut::Part out;
    for (int f = 0; f < p.mesh.face_count(); ++f)
      for (int repeat = 0; repeat < (f % 10 == 0 ? 2 : 1); ++repeat) {
        const int v = out.mesh.vertex_count();
        for (int k = 0; k < 3; ++k) out.mesh.vertices.push_back(p.mesh.corner(f, k));
        if (f % 7 == 0)
          out.mesh.faces.push_back({v, v + 2, v + 1});  // turned over
        else
          out.mesh.faces.push_back({v, v + 1, v + 2});
        out.keep.push_back(p.keep[f]);
      }
    const int v = out.mesh.vertex_count();
    out.mesh.vertices.emplace_back(std::nan(""), 0, 0);
    out.mesh.vertices.emplace_back(0, kInfinity, 0);
    for (const Triangle& t : {Triangle{0, 1, v}, {v, v + 1, 0}, {0, 0, 1}, {2, 2, 2}})
      out.mesh.faces.push_back(t), out.keep.push_back(0);
    return out;
  };
  const compose::ComposeResult clean = compose_quietly(a, b), r = compose_quietly(spoiled(a), spoiled(b));
  expect_closed_manifold(r.composed, "soup");
  EXPECT_NEAR(volume_of(r.composed), volume_of(clean.composed), 1e-3);
}

TEST(ComposeNasty, ZeroAreaFacesKeepTheSurfaceClosed) {
  auto [a, b] = two_spheres();
  for (cut::Part* p : {&a, &b}) {
    // Splits an edge in twenty faces at a corner's own place: slivers of no area.
    Mesh& m = p->mesh;
    for (int f = 0; f < 20; ++f) {
      const Triangle t = m.faces[f * 37 % m.face_count()];
      const int v = m.vertex_count();
      m.vertices.push_back(0.5 * (m.vertices[t[0]] + m.vertices[t[1]]));
      m.faces[f * 37 % m.face_count()] = {v, t[1], t[2]};
      m.faces.push_back({t[0], v, t[2]});
      m.faces.push_back({t[1], v, t[0]});  // closes the T with no area
      p->keep.push_back(0), p->keep.push_back(0);
    }
  }
  const compose::ComposeResult r = compose_quietly(a, b);
  const mesh::MeshCheck c = mesh::check(r.composed);
  EXPECT_TRUE(c.closed() && c.oriented()) << mesh::to_string(c);
  EXPECT_EQ(c.nonmanifold_edges, 0);
}

TEST(ComposeNasty, NonManifoldEdgesAndVertices) {
  const auto [plain, b] = two_spheres();
  // A fin on an edge far from the seam, and a second sphere that touches at a vertex.
  cut::Part a = plain;
  Mesh& m = a.mesh;
  const Triangle t = m.faces[faces_where(m, [](const Vec3& c) { return c.x() > 0; })[0] ? 0 : 1];
  m.vertices.push_back(2 * m.vertices[t[0]]);
  m.faces.push_back({t[0], t[1], m.vertex_count() - 1});
  const Vec3 tip = m.vertices[t[2]];
  Mesh ball = sphere(Vec3::Zero(), 0.2, 2);
  ball = moved(ball, Eigen::Affine3d(Eigen::Translation3d(tip - ball.vertices[0])));
  m = together({m, ball});
  a.keep.resize(m.faces.size(), 0);
  const compose::ComposeResult r = compose_quietly(a, b);
  EXPECT_EQ(missing_faces(r, a, b), 0);
  EXPECT_EQ(mesh::check(r.composed).nonfinite_vertices, 0);
}

TEST(ComposeNasty, CoincidentCopies) {
  // The same layer twice, its two halves kept.
  const Mesh mesh = noisy_sphere(Vec3::Zero(), 1, 4, 0.4, 3);
  const cut::Part a{mesh, faces_where(mesh, [](const Vec3& c) { return c.x() < -0.5; })};
  const cut::Part b{mesh, faces_where(mesh, [](const Vec3& c) { return c.x() > 0.5; })};
  for (const cut::Cut cut : {cut::Cut::Mesh, cut::Cut::Thesis}) {
    compose::ComposeOptions options;
    options.cut = cut;
    const compose::ComposeResult r = compose_quietly(a, b, options);
    EXPECT_EQ(missing_faces(r, a, b), 0);
    expect_closed_manifold(r.composed, "copies");
    if (cut == cut::Cut::Thesis) continue;
    EXPECT_NEAR(volume_of(r.composed), volume_of(mesh), 0.02);
    EXPECT_EQ(mesh::check(r.composed).euler, 2);
    EXPECT_EQ(mesh::self_intersections(r.composed), 0);
    EXPECT_NEAR(volume_of(r.composed), volume_of(mesh), 1e-5);  // nothing moved
  }
}

TEST(ComposeNasty, NearlyCoincidentCopies) {
  for (const double apart : {0.003, 0.01, 0.03}) {
    const Mesh mesh = noisy_sphere(Vec3::Zero(), 1, 4, 0.4, 3);
    const Mesh other = moved(mesh, Eigen::Affine3d(Eigen::Scaling(1 + apart)));
    const cut::Part a{mesh, faces_where(mesh, [](const Vec3& c) { return c.x() < -0.5; })};
    const cut::Part b{other, faces_where(other, [](const Vec3& c) { return c.x() > 0.5; })};
    const compose::ComposeResult r = compose_quietly(a, b);
    expect_closed_manifold(r.composed, "apart by " + std::to_string(apart));
    EXPECT_EQ(mesh::check(r.composed).components, 1) << apart;
    EXPECT_NEAR(volume_of(r.composed), volume_of(mesh), 0.1 * volume_of(mesh)) << apart;
  }
}

TEST(ComposeNasty, SeveralComponentsEach) {
  const Mesh three = together({sphere({-2.5, 0, 0}, 1, 3), sphere({0, 0, 0}, 1, 3), sphere({2.5, 0, 0}, 1, 3)});
  std::vector<Ball> path;
  for (int i = 0; i <= 24; ++i) path.push_back({{0.25 * i - 3, 0.9, 0}, 0.3});
  const Mesh bar = tube(path);
  const cut::Part a{three, faces_where(three, [](const Vec3& c) { return c.y() < -0.8; })};
  const cut::Part b{bar, faces_where(bar, [](const Vec3& c) { return std::abs(c.x() - 1.2) < 0.1; })};
  const compose::ComposeResult r = compose_quietly(a, b);
  expect_closed_manifold(r.composed, "three balls and a bar");
  EXPECT_EQ(missing_faces(r, a, b), 0);
}

TEST(ComposeNasty, HugeFacesAndTinyOnes) {
  const Mesh slab = box({-50, -50, -1}, {50, 50, 0});  // twelve faces
  const Mesh ball = sphere({0, 0, 0.4}, 1, 4);
  const cut::Part a{slab, faces_where(slab, [](const Vec3& c) { return c.z() < -0.9; })};
  const cut::Part b{ball, faces_where(ball, [](const Vec3& c) { return c.z() > 1.2; })};
  const compose::ComposeResult r = compose_quietly(a, b);
  expect_closed_manifold(r.composed, "a ball on a slab");
  EXPECT_EQ(missing_faces(r, a, b), 0);
}

TEST(ComposeNasty, FlatModels) {
  // All in one plane: no volume, still a surface with a boundary.
  const auto square = [](double x) {
    Mesh m = box({x, 0, 0}, {x + 2, 2, 1}, 8);
    return mesh::take_faces(m, faces_where(m, [](const Vec3& c) { return c.z() == 1; }));
  };
  const Mesh left = square(0), right = square(1);
  const cut::Part a{left, faces_where(left, [](const Vec3& c) { return c.x() < 0.5; })};
  const cut::Part b{right, faces_where(right, [](const Vec3& c) { return c.x() > 2.5; })};
  const compose::ComposeResult r = compose_quietly(a, b);
  const mesh::MeshCheck c = mesh::check(r.composed);
  EXPECT_TRUE(c.manifold() && c.oriented()) << mesh::to_string(c);
  EXPECT_EQ(missing_faces(r, a, b), 0);
  // The cut ends along the other sheet's own border; what is not joined is said.
  EXPECT_TRUE(c.components == 1 || r.report.loops_joined + r.report.pieces_joined == 0) << mesh::to_string(c);
}

TEST(ComposeNasty, AModelOfOneFace) {
  cut::Part one;
  one.mesh.vertices = {{-2, 0.01, 0}, {2, 0, 0.3}, {2, 0, -0.3}};
  one.mesh.faces = {{0, 1, 2}};
  one.keep = {1};
  const auto [a, b] = two_spheres();
  // Whatever it gives, no crash and the kept face is there.
  const std::string sentence = user_error([&, &a = a] {
    const compose::ComposeResult r = compose_quietly(a, one);
    EXPECT_EQ(missing_faces(r, a, one), 0);
  });
  SUCCEED() << sentence;
}

}  // namespace
}  // namespace parts::test
