// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "mend_support.h"
#include "parts/mesh/self_intersections.h"

namespace parts::test {
namespace {

TEST(Mend, ClosesHolesTooSmallForAnyDetailWithoutASearch) {
  Mesh scan = sphere();
  std::vector<char> stays(scan.faces.size(), 1);
  const int v = scan.faces[100][0];  // a whole fan goes, and a face elsewhere
  for (int f = 0; f < scan.face_count(); ++f)
    for (int u : scan.faces[f]) stays[f] = stays[f] && u != v;
  stays[900] = 0;
  scan = mesh::take_faces(scan, stays);
  ASSERT_EQ(mesh::check(scan).boundary_loops, 2);
  const mend::Mended m = fill_all(scan, {sphere()});
  EXPECT_EQ(m.count(mend::RegionReport::End::Small), 2);
  EXPECT_TRUE(m.candidates.empty());
  expect_closed_manifold(m.mesh, "sphere");
}

TEST(Mend, FillsAHoleWithATornRim) {
  // By one corner alone: teeth that hang together in vertices, and crumbs.
  const Mesh whole = mesh::prepare(own_bust()).mesh;
  const Vec3 at = bust_landmarks(random_bust(3)).nose_tip;
  std::vector<char> stays(whole.faces.size());
  for (int f = 0; f < whole.face_count(); ++f) stays[f] = (whole.corner(f, 0) - at).norm() > 0.2;
  const Mesh scan = mesh::take_faces(whole, stays);
  ASSERT_GT(mesh::check(scan).nonmanifold_vertices, 0);
  const mend::Mended mended = fill_all(scan, {similar_bust()[0].mesh});
  // As a file without indices holds it, too: vertices at the same place are one.
  for (const Mesh& mesh : {mended.mesh, mesh::welded(mended.mesh)}) {
    const mesh::MeshCheck c = mesh::check(mesh);
    EXPECT_TRUE(c.manifold()) << mesh::to_string(c);
    EXPECT_EQ(c.boundary_edges, 0);
    EXPECT_EQ(c.components, 1);
  }
}

/// A sphere without the faces about some directions.
Mesh holed_sphere(const std::vector<Vec3>& at, double angle, int subdivisions = 4) {
  const Mesh whole = sphere(Vec3::Zero(), 1, subdivisions);
  return mesh::take_faces(whole, faces_where(whole, [&](const Vec3& c) {
                            return std::all_of(at.begin(), at.end(), [&](const Vec3& d) {
                              return c.normalized().dot(d.normalized()) < std::cos(angle);
                            });
                          }));
}

/// Another triangulation of the unit sphere.
Mesh turned_sphere() {
  return moved(sphere(Vec3::Zero(), 1, 4), Eigen::Affine3d(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())));
}

/// Closed, manifold also where vertices at the same place are one, crossing
/// nothing, and on the unit sphere.
void expect_whole_sphere(const Mesh& mesh, double off) {
  const mesh::MeshCheck c = mesh::check(mesh::welded(mesh));
  EXPECT_TRUE(c.closed() && c.manifold()) << mesh::to_string(c);
  EXPECT_EQ(c.components, 1);
  EXPECT_EQ(c.euler, 2);
  EXPECT_EQ(mesh::self_intersections(mesh), 0);
  for (int f = 0; f < mesh.face_count(); ++f) EXPECT_NEAR(mesh.center(f).norm(), 1, off);
}

TEST(Mend, HolesThatShareAVertexAreFilledEachByItself) {
  // The fans around a vertex: two opposite wedges go, and what lies beyond each.
  const Mesh whole = sphere(Vec3::Zero(), 1, 4);
  const Vec3 p = whole.vertices[whole.faces[700][0]], x = p.unitOrthogonal(), y = p.cross(x);
  const auto side = [&](const Vec3& c, const Vec3& to) {
    const Vec3 d = c - p;
    return d.norm() < 0.5 && d.dot(to) > 0.7 * d.norm();
  };
  const Mesh scan = mesh::take_faces(
      whole, faces_where(whole, [&](const Vec3& c) { return !side(c, x) && !side(c, -x) && y.norm() > 0; }));
  ASSERT_EQ(mesh::check(scan).nonmanifold_vertices, 1);
  ASSERT_EQ(mesh::check(scan).boundary_loops, 1);  // along the fans
  const mend::Scan ready(scan);
  ASSERT_EQ(ready.rims().size(), 2u);  // along the holes
  const mend::Mended m = fill_all(scan, {turned_sphere()});
  EXPECT_EQ(m.regions.size(), 2u);
  EXPECT_EQ(m.count(mend::RegionReport::End::Left), 0);
  expect_whole_sphere(m.mesh, 0.01);
}

TEST(Mend, HolesAtAThinBridgeAreFilledEachByItself) {
  const Mesh whole = sphere(Vec3::Zero(), 1, 4);
  const double width = 0.1;  // a face or two
  const Mesh scan = mesh::take_faces(
      whole, faces_where(whole, [&](const Vec3& c) { return c.z() < 0.8 || std::abs(c.x()) < width / 2; }));
  const mend::Scan ready(scan);
  ASSERT_EQ(ready.rims().size(), 2u);
  const mend::Mended m = fill_all(scan, {turned_sphere()});
  EXPECT_EQ(m.count(mend::RegionReport::End::Left), 0);
  expect_whole_sphere(m.mesh, 0.01);
}

TEST(Mend, BothWallsOfAHollowShellAreClosed) {
  const auto wall = [](double radius) {
    const Mesh whole = sphere(Vec3::Zero(), radius, 4);
    return mesh::take_faces(
        whole, faces_where(whole, [](const Vec3& c) { return (c.normalized() - Vec3::UnitZ()).norm() > 0.5; }));
  };
  const double thickness = 0.08;
  Mesh inner = wall(1 - thickness);
  mesh::flip_orientation(inner);
  const mend::Mended m = fill_all(together({wall(1), inner}), {turned_sphere()});
  EXPECT_EQ(m.count(mend::RegionReport::End::Left), 0) << mend::summary(m, true);
  const mesh::MeshCheck c = mesh::check(mesh::welded(m.mesh));
  EXPECT_TRUE(c.closed() && c.manifold() && c.oriented()) << mesh::to_string(c);
  EXPECT_EQ(c.components, 2);
  EXPECT_EQ(mesh::self_intersections(m.mesh), 0);
  double volume = 0;
  for (const Triangle& f : m.mesh.faces)
    volume += m.mesh.vertices[f[0]].dot(m.mesh.vertices[f[1]].cross(m.mesh.vertices[f[2]])) / 6;
  const double shell = 4 * M_PI / 3 * (1 - std::pow(1 - thickness, 3));
  EXPECT_NEAR(volume, shell, 0.03 * shell);
}

TEST(Mend, AFinIsNoHole) {
  Mesh scan = sphere();
  const int a = scan.faces[0][0], b = scan.faces[0][1], n = scan.vertex_count();
  scan.vertices.push_back(1.3 * scan.vertices[a]), scan.vertices.push_back(1.3 * scan.vertices[b]);
  scan.faces.push_back({a, b, n + 1}), scan.faces.push_back({a, n + 1, n});
  EXPECT_NE(user_error([&] { fill_all(scan, {sphere()}); }).find("more than two faces"), std::string::npos);
  // With a hole elsewhere: that is filled, and nothing added to the fin.
  const int before = scan.face_count();
  std::vector<char> stays(scan.faces.size(), 1);
  stays[900] = 0;
  const mend::Mended m = fill_all(mesh::take_faces(scan, stays), {sphere()});
  EXPECT_EQ(m.regions.size(), 1u);
  EXPECT_EQ(m.chains, 1);
  EXPECT_EQ(m.mesh.face_count(), before);
  EXPECT_NE(mend::summary(m, true).find("more than two faces"), std::string::npos) << mend::summary(m, true);
}

TEST(Mend, CountsFacesRightAfterALaterPatch) {
  const NoseHole n;
  const Vec3 crown = bust_landmarks(n.shape).crown;
  Mesh scan = without_ball(n.scan, crown, 0.3);
  std::vector<char> piece(n.whole.faces.size());
  for (int f = 0; f < n.whole.face_count(); ++f)
    piece[f] = (n.whole.corner(f, 0) - n.tip - Vec3(0, 0.06, -0.02)).norm() < 0.035;
  const int loose = int(std::count(piece.begin(), piece.end(), 1));
  mesh::append(scan, mesh::take_faces(n.whole, piece));
  const mend::Mended m = fill_all(scan, {similar_bust()[0].mesh});
  ASSERT_EQ(m.count(mend::RegionReport::End::Mended), 2);
  int added = 0, replaced = 0;
  for (const mend::RegionReport& r : m.regions) added += r.restored.faces_added, replaced += r.restored.faces_replaced;
  EXPECT_EQ(m.regions[0].restored.faces_replaced, 0);  // the crown, the longer rim
  EXPECT_EQ(m.regions[1].restored.faces_replaced, loose);
  EXPECT_EQ(mend::Scan(scan).mesh().face_count() - replaced + added, m.mesh.face_count());
  EXPECT_EQ(std::count(m.mesh.face_selected.begin(), m.mesh.face_selected.end(), 1), added);
}

TEST(Mend, ProgressNeverGoesBack) {
  const NoseHole n;
  const Mesh scan = without_ball(n.scan, bust_landmarks(n.shape).crown, 0.3);
  int before = 0, reports = 0;
  std::string stage_before;
  fill_all(scan, {similar_bust()[0].mesh, own_bust()}, around_holes(), Progress([&](int percent, const char* stage) {
             EXPECT_GE(percent, before) << stage << " after " << stage_before;
             EXPECT_LE(percent, 100);
             before = percent, stage_before = stage, ++reports;
             return true;
           }));
  EXPECT_GT(reports, 20);
}

TEST(Mend, WhatNoModelClosesIsLeftAndNamed) {
  const Mesh scan = holed_sphere({Vec3(0, 0, 1), Vec3(0, 0, -1)}, 0.4), model = holed_sphere({Vec3(0, 0, -1)}, 0.6);
  mend::RegionOptions where = around_holes();
  int searches = 0;
  std::string last;
  const mend::Mended m = fill_all(scan, {model}, where, Progress([&](int, const char* stage) {
                                    searches += last != stage && std::string(stage) == "Preparing the scan";
                                    last = stage;
                                    return true;
                                  }));
  ASSERT_EQ(m.regions.size(), 2u);
  EXPECT_EQ(m.count(mend::RegionReport::End::Left), 1);
  EXPECT_EQ(searches, 2);  // one try each
  const auto left = std::find_if(m.regions.begin(), m.regions.end(),
                                 [](const auto& r) { return r.end == mend::RegionReport::End::Left; });
  EXPECT_LT(left->center.z(), 0);
  EXPECT_GT(left->edges, 10);
  const std::string words = mend::summary(m, true);
  EXPECT_EQ(words.find("1 of 2 holes filled; the hole of " + std::to_string(left->edges)), 0u) << words;
  EXPECT_EQ(mesh::check(m.mesh).boundary_loops, 1);
}

}  // namespace
}  // namespace parts::test
