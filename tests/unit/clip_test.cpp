// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/clip.h"

#include "parts/mesh/loops.h"
#include "unit/compose_support.h"

namespace parts::test {
namespace {

/// Clips by a plane: kept where (p - point) . normal > 0.
seam::ClipField plane(const Vec3& point, const Vec3& normal, double max_edge = 1e9) {
  seam::ClipField field;
  field.value = [=](const Vec3& p) { return (p - point).dot(normal); };
  field.crosses = [=](const Mesh& m, int f) {
    double low = 1e300, high = -1e300;
    for (int k = 0; k < 3; ++k) {
      const double v = (m.corner(f, k) - point).dot(normal);
      low = std::min(low, v), high = std::max(high, v);
    }
    return low <= 0 && high >= 0;
  };
  field.max_edge = max_edge;
  return field;
}

std::vector<signed char> free_faces(const Mesh& mesh) { return std::vector<signed char>(mesh.faces.size(), 0); }

double area(const Mesh& mesh) {
  double sum = 0;
  for (int f = 0; f < mesh.face_count(); ++f) sum += mesh.area(f);
  return sum;
}

TEST(Clip, TheTwoSidesOfAPlaneMakeTheWhole) {
  Random random(1);
  for (int n = 0; n < 40; ++n) {
    const Mesh mesh = n % 2 ? torus() : noisy_sphere(Vec3::Zero(), 1, 3, 0.4, unsigned(n));
    const Vec3 normal = random.direction(), point = 0.3 * random.direction();
    const double max_edge = n % 3 ? 1e9 : 0.05;
    const seam::Clipped above = seam::clip(mesh, free_faces(mesh), plane(point, normal, max_edge), 1),
                        below = seam::clip(mesh, free_faces(mesh), plane(point, -normal, max_edge), 1);
    EXPECT_NEAR(area(above.mesh) + area(below.mesh), area(mesh), 0.02 * area(mesh));
    for (const seam::Clipped* c : {&above, &below}) {
      const double side = c == &above ? 1 : -1;
      ASSERT_EQ(c->source_face.size(), c->mesh.faces.size());
      ASSERT_EQ(c->cut_vertex.size(), c->mesh.vertices.size());
      const std::set<FaceKey> input = face_keys(mesh);
      for (int f = 0; f < c->mesh.face_count(); ++f) {
        bool crossed = false;
        for (int k = 0; k < 3; ++k) {
          const double v = side * (mesh.corner(c->source_face[f], k) - point).dot(normal);
          crossed |= v <= 0;
          EXPECT_GE(side * (c->mesh.corner(f, k) - point).dot(normal), -0.02);
        }
        EXPECT_TRUE(crossed || max_edge < 1 || input.count(face_key(c->mesh, f))) << "a whole face was changed";
      }
    }
    EXPECT_EQ(above.border.size(), below.border.size());
  }
}

TEST(Clip, TheBorderIsTheBoundaryAndRunsWithTheFaces) {
  const Mesh mesh = torus();
  const seam::Clipped c = seam::clip(mesh, free_faces(mesh), plane({0, 0.1, 0}, {0, 1, 0}), 1);
  std::set<std::array<int, 2>> boundary;
  for (const auto& e : mesh::boundary_half_edges(c.mesh)) boundary.insert(e);
  EXPECT_EQ(boundary, (std::set<std::array<int, 2>>(c.border.begin(), c.border.end())));
  const std::vector<mesh::Loop> loops = mesh::trace_loops(c.border);
  ASSERT_EQ(loops.size(), 2u);
  for (const mesh::Loop& l : loops) {
    EXPECT_TRUE(l.closed);
    for (int v : l.vertices) {
      EXPECT_TRUE(c.cut_vertex[v]);
      EXPECT_NEAR(c.mesh.vertices[v].y(), 0.1, 2e-3);
    }
  }
  const mesh::MeshCheck check_ = mesh::check(c.mesh);
  EXPECT_TRUE(check_.manifold() && check_.oriented());
}

TEST(Clip, CrossedFacesAreSplitWithoutCracks) {
  const Mesh mesh = box({-1, -1, -1}, {1, 1, 1});  // twelve large faces
  seam::ClipField field = plane(Vec3::Zero(), {0, 0, 1}, 0.1);
  // A wavy zero set that the corners alone could not show.
  field.value = [](const Vec3& p) { return p.z() - 0.2 * std::sin(6 * p.x()) * std::cos(5 * p.y()); };
  const seam::Clipped c = seam::clip(mesh, free_faces(mesh), field, 1);
  const mesh::MeshCheck result = mesh::check(c.mesh);
  EXPECT_TRUE(result.manifold() && result.oriented()) << mesh::to_string(result);
  EXPECT_EQ(result.boundary_loops, 1);
  for (const auto& e : c.border)
    for (int v : e) EXPECT_NEAR(field.value(c.mesh.vertices[v]), 0, 0.02);
}

TEST(Clip, PinnedFacesStayWholeOrGo) {
  const Mesh mesh = sphere(Vec3::Zero(), 1, 4);
  std::vector<signed char> pinned = free_faces(mesh);
  const auto kept = faces_where(mesh, [](const Vec3& c) { return (c - Vec3(0, 1, 0)).norm() < 0.4; });
  const auto gone = faces_where(mesh, [](const Vec3& c) { return (c - Vec3(0, -1, 0)).norm() < 0.4; });
  for (int f = 0; f < mesh.face_count(); ++f) pinned[f] = kept[f] ? 1 : gone[f] ? -1 : 0;
  for (const double max_edge : {1e9, 0.02}) {
    const seam::Clipped c = seam::clip(mesh, pinned, plane(Vec3::Zero(), {0, 0, 1}, max_edge), 1);
    const std::set<FaceKey> keys = face_keys(c.mesh);
    for (int f = 0; f < mesh.face_count(); ++f) {
      EXPECT_TRUE(!kept[f] || keys.count(face_key(mesh, f)));
      EXPECT_TRUE(!gone[f] || !keys.count(face_key(mesh, f)));
    }
    const mesh::MeshCheck result = mesh::check(c.mesh);
    EXPECT_TRUE(result.manifold() && result.oriented()) << mesh::to_string(result);
    EXPECT_EQ(result.boundary_loops, 1);
  }
}

TEST(Clip, AttributesAreLinearAlongCuts) {
  Mesh mesh = torus();
  mesh.textures = {"t.png"};
  for (const Vec3& v : mesh.vertices) mesh.vertex_quality.push_back(float(v.x() + 2 * v.y()));
  for (int f = 0; f < mesh.face_count(); ++f) {
    mesh.face_quality.push_back(float(f));
    mesh.wedges.emplace_back();
    mesh.wedges[f].texture = 0;
    for (int k = 0; k < 3; ++k) mesh.wedges[f].uv[k] = mesh.corner(f, k).head<2>().cast<float>();
  }
  const seam::Clipped c =
      seam::clip(mesh, free_faces(mesh), plane({0.05, 0, 0}, Vec3(1, 0.3, 0.2).normalized(), 0.03), 2);
  for (int v = 0; v < c.mesh.vertex_count(); ++v)
    EXPECT_NEAR(c.mesh.vertex_quality[v], c.mesh.vertices[v].x() + 2 * c.mesh.vertices[v].y(), 1e-5);
  for (int f = 0; f < c.mesh.face_count(); ++f) {
    EXPECT_EQ(c.mesh.face_quality[f], float(c.source_face[f]));
    for (int k = 0; k < 3; ++k)
      EXPECT_LT((c.mesh.wedges[f].uv[k].cast<double>() - c.mesh.corner(f, k).head<2>()).norm(), 1e-5);
  }
}

TEST(Clip, AllNothingAndTheSameForAnyNumberOfThreads) {
  const Mesh mesh = torus();
  const seam::Clipped all = seam::clip(mesh, free_faces(mesh), plane({0, 0, -9}, {0, 0, 1}, 0.01), 1);
  EXPECT_EQ(all.mesh.vertices, mesh.vertices);
  EXPECT_EQ(all.mesh.faces, mesh.faces);
  EXPECT_TRUE(all.border.empty());
  EXPECT_EQ(seam::clip(mesh, free_faces(mesh), plane({0, 0, 9}, {0, 0, 1}), 1).mesh.face_count(), 0);
  const seam::ClipField field = plane({0.1, 0, 0}, {1, 0, 0}, 0.02);
  const seam::Clipped one = seam::clip(mesh, free_faces(mesh), field, 1),
                      eight = seam::clip(mesh, free_faces(mesh), field, 8);
  EXPECT_EQ(one.mesh.vertices, eight.mesh.vertices);
  EXPECT_EQ(one.mesh.faces, eight.mesh.faces);
  EXPECT_EQ(one.border, eight.border);
}

}  // namespace
}  // namespace parts::test
