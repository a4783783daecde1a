// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/busts.h"

#include <gtest/gtest.h>

#include "parts/mesh/self_intersections.h"
#include "parts/mesh/topology.h"

namespace parts::test {
namespace {

double distance_to_vertices(const Mesh& mesh, const Vec3& p) {
  double nearest = 1e9;
  for (const Vec3& v : mesh.vertices) nearest = std::min(nearest, (v - p).norm());
  return nearest;
}

TEST(Busts, AreClosedFacesInColour) {
  for (unsigned seed : {1u}) {
    const BustShape shape = random_bust(seed);
    const Mesh mesh = bust_mesh(shape, "a.png");
    const mesh::MeshCheck c = mesh::check(mesh);
    EXPECT_TRUE(c.closed() && c.manifold() && c.oriented()) << mesh::to_string(c);
    EXPECT_EQ(c.components, 1);
    EXPECT_EQ(c.euler, 2);
    EXPECT_GE(c.faces, 8000);
    EXPECT_LE(c.faces, 12000);
    ASSERT_EQ(mesh.wedges.size(), mesh.faces.size());
    for (const Wedges& w : mesh.wedges)
      for (const Eigen::Vector2f& uv : w.uv) ASSERT_TRUE(uv.minCoeff() >= 0 && uv.maxCoeff() <= 1) << uv.transpose();
    const BustLandmarks at = bust_landmarks(shape);
    for (const Vec3& p : {at.nose_tip, at.crown, at.chin}) EXPECT_LT(distance_to_vertices(mesh, p), 0.03);
    double front = 0;
    for (const Vec3& v : mesh.vertices) front = std::max(front, v.z());
    EXPECT_NEAR(at.nose_tip.z(), front, 0.02) << "the nose is the foremost";
  }
}

TEST(Busts, DependOnTheSeedAlone) {
  const BustShape a = random_bust(5);
  const Mesh one = bust_mesh(a, "", 32), same = bust_mesh(random_bust(5), "", 32),
             other = bust_mesh(random_bust(6), "", 32);
  EXPECT_EQ(one.vertices, same.vertices);
  EXPECT_NE(one.vertices, other.vertices);
  const cv::Mat image = bust_texture(a, one, 128);
  EXPECT_EQ(cv::norm(image, bust_texture(a, same, 128), cv::NORM_INF), 0);
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  EXPECT_GT(deviation[0], 15) << "skin, hair and shirt";
}

TEST(Busts, AreDamagedWhereTheyShould) {
  const BustShape shape = random_bust(3);
  const Mesh mesh = bust_mesh(shape, "", 32);
  const BustLandmarks at = bust_landmarks(shape);
  const mesh::MeshCheck hole = mesh::check(without_ball(mesh, at.nose_tip, 0.16));
  EXPECT_EQ(hole.boundary_loops, 1);
  EXPECT_TRUE(hole.manifold());
  std::vector<char> faces;
  const Mesh scar = gouged(mesh, at.nose_tip, 0.12, 0.08, 1, &faces);
  ASSERT_EQ(scar.faces, mesh.faces);
  EXPECT_GT(std::count(faces.begin(), faces.end(), 1), 20);
  double deepest = 0;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const double moved = (scar.vertices[v] - mesh.vertices[v]).norm();
    if ((mesh.vertices[v] - at.nose_tip).norm() > 0.12) {
      EXPECT_EQ(moved, 0);
    }
    deepest = std::max(deepest, moved);
  }
  EXPECT_GT(deepest, 0.03);
}

}  // namespace
}  // namespace parts::test
