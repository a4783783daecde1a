// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/constraint.h"

#include "unit/compose_support.h"

namespace parts::test {
namespace {

std::vector<char> by_box(const Mesh& mesh, const Vec3& min, const Vec3& max) {
  return compose::constrained_faces(mesh, compose::ConstraintBy::Box, min, max, "model A");
}

TEST(Constraint, SelectedFacesAndVertices) {
  Mesh mesh = sphere();
  mesh.face_selected = faces_where(mesh, [](const Vec3& c) { return c.z() > 0.5; });
  EXPECT_EQ(compose::constrained_faces(mesh, compose::ConstraintBy::SelectedFaces, {}, {}, "A"), mesh.face_selected);
  mesh.vertex_selected.assign(mesh.vertices.size(), 0);
  mesh.vertex_selected[5] = 1;
  const std::vector<char> around =
      compose::constrained_faces(mesh, compose::ConstraintBy::SelectedVertices, {}, {}, "A");
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Triangle& t = mesh.faces[f];
    EXPECT_EQ(around[f] != 0, t[0] == 5 || t[1] == 5 || t[2] == 5);
  }
}

TEST(Constraint, ABoxMarksTheFacesItTouches) {
  const Mesh mesh = sphere(Vec3::Zero(), 1, 4);
  const std::vector<char> keep = by_box(mesh, {0.5, -2, -2}, {2, 2, 2});
  for (int f = 0; f < mesh.face_count(); ++f) EXPECT_EQ(keep[f] != 0, mesh.face_box(f).max().x() >= 0.5);
  // A face that the box passes through, no corner of it inside.
  Mesh big;
  big.vertices = {{-9, -9, 0}, {9, -9, 0}, {0, 18, 0}};
  big.faces = {{0, 1, 2}};
  EXPECT_EQ(by_box(big, {-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1})[0], 1);
  // One whose bounding box alone reaches in.
  EXPECT_FALSE(user_error([&] { by_box(big, {7, 16, -1}, {8, 17, 1}); }).empty());
}

TEST(Constraint, FlatBoxesAndLines) {
  const Mesh mesh = box({0, 0, 0}, {1, 1, 1}, 4);
  const std::vector<char> top = by_box(mesh, {0, 0, 1}, {1, 1, 1});
  for (int f = 0; f < mesh.face_count(); ++f) EXPECT_EQ(top[f] != 0, mesh.face_box(f).max().z() == 1);
  const std::vector<char> line = by_box(mesh, {0.4, 0.4, -5}, {0.4, 0.4, 5});
  EXPECT_GE(std::count(line.begin(), line.end(), 1), 2);
  EXPECT_LE(std::count(line.begin(), line.end(), 1), 4);
}

TEST(Constraint, APointMarksTheNearestFace) {
  const Mesh mesh = sphere(Vec3::Zero(), 1, 4);
  Random random(1);
  for (int n = 0; n < 50; ++n) {
    const Vec3 direction = random.direction();
    const std::vector<char> keep = by_box(mesh, 0.99 * direction, 0.99 * direction);
    ASSERT_EQ(std::count(keep.begin(), keep.end(), 1), 1);
    const int f = int(std::find(keep.begin(), keep.end(), 1) - keep.begin());
    // The ray from the centre passes through it, or hardly beside it.
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = mesh.corner(f, k);
    EXPECT_GE(Vec3(corners.inverse() * direction).minCoeff(), -0.05);
  }
}

TEST(Constraint, NaNCornersAreNeverNearest) {
  Mesh mesh = sphere();
  mesh.vertices[0].x() = std::nan("");
  const std::vector<char> keep = by_box(mesh, {1, 0, 0}, {1, 0, 0});
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(!keep[f] || mesh.corner(f, k).allFinite());
  EXPECT_NO_THROW(by_box(mesh, {-2, -2, -2}, {2, 2, 2}));
}

TEST(Constraint, EverySentenceNamesTheModel) {
  const Mesh mesh = sphere();
  const double nan = std::nan("");
  const std::vector<std::string> sentences{
      user_error([&] { compose::constrained_faces(mesh, compose::ConstraintBy::SelectedFaces, {}, {}, "the hat"); }),
      user_error([&] { compose::constrained_faces(mesh, compose::ConstraintBy::SelectedVertices, {}, {}, "the hat"); }),
      user_error([&] { compose::constrained_faces(Mesh(), compose::ConstraintBy::SelectedFaces, {}, {}, "the hat"); }),
      user_error([&] {
        compose::constrained_faces(mesh, compose::ConstraintBy::Box, {3, 3, 3}, {4, 4, 4}, "the hat");
      }),
      user_error([&] {
        compose::constrained_faces(mesh, compose::ConstraintBy::Box, {0, 0, 1}, {1, 1, 0}, "the hat");
      }),
      user_error([&] {
        compose::constrained_faces(mesh, compose::ConstraintBy::Box, {nan, 0, 0}, {1, 1, 1}, "the hat");
      }),
  };
  std::set<std::string> different;
  for (const std::string& s : sentences) {
    EXPECT_NE(s.find("the hat"), std::string::npos) << s;
    EXPECT_TRUE(!s.empty() && s.back() == '.') << s;
    different.insert(s);
  }
  EXPECT_EQ(different.size(), sentences.size());
}

}  // namespace
}  // namespace parts::test
