// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "mend_support.h"
#include "parts/mesh/slits.h"

namespace parts::test {
namespace {

TEST(Region, OneForEachFlaw) {
  Mesh m = sphere();
  m.face_selected = faces_where(m, [](const Vec3& c) { return std::abs(c.x()) > 0.95; });
  Progress silent;
  EXPECT_EQ(mend::flaw_regions(mend::Scan(m), {}, silent).size(), 2u);
}

TEST(Region, HolesLeftOutBySizeAndBySelection) {
  const Mesh whole = sphere();
  std::vector<char> stays = faces_where(whole, [](const Vec3& c) { return c.x() < 0.95 && c.x() > -0.7; });
  Mesh scan = mesh::take_faces(whole, stays);
  mend::RegionOptions o = around_holes();
  EXPECT_EQ(mend::hole_regions(mend::Scan(scan), o).size(), 2u);
  o.longest_rim = 3;
  EXPECT_EQ(mend::hole_regions(mend::Scan(scan), o).size(), 1u);
  o.longest_rim = 0;
  scan.face_selected = faces_where(scan, [](const Vec3& c) { return c.x() < -0.6; });
  ASSERT_EQ(mend::hole_regions(mend::Scan(scan), o).size(), 1u);
  EXPECT_GT(mend::hole_regions(mend::Scan(scan), o)[0].box.center().x(), 0);
  o.by = mend::RegionBy::Selection;
  ASSERT_EQ(mend::hole_regions(mend::Scan(scan), o).size(), 1u);
  EXPECT_LT(mend::hole_regions(mend::Scan(scan), o)[0].box.center().x(), 0);
}

TEST(Region, SaysWhatIsMissing) {
  const mend::Scan closed(sphere());
  Progress silent;
  mend::RegionOptions o = around_holes();
  EXPECT_NE(user_error([&] { mend::hole_regions(closed, o); }).find("no hole"), std::string::npos);
  EXPECT_NE(user_error([&] { mend::flaw_regions(closed, {}, silent); }).find("No face is selected"), std::string::npos);
  o.by = mend::RegionBy::Box;
  o.box = Box(Vec3(5, 5, 5), Vec3(6, 6, 6));
  EXPECT_NE(user_error([&] { mend::flaw_regions(closed, o, silent); }).find("no surface"), std::string::npos);
  o.box = Box(Vec3(1, 1, 1), Vec3(-1, -1, -1));
  EXPECT_NE(user_error([&] { mend::flaw_regions(closed, o, silent); }).find("no thickness"), std::string::npos);
  EXPECT_NE(user_error([&] { mend::flaw_regions(mend::Scan(Mesh()), o, silent); }).find("no face"), std::string::npos);
}

TEST(Region, TheSelectedHolesWhereThereAreAnyElseAll) {
  const Mesh whole = sphere();
  Mesh scan = mesh::take_faces(whole, faces_where(whole, [](const Vec3& c) { return std::abs(c.x()) < 0.9; }));
  mend::RegionOptions o;
  o.by = mend::RegionBy::SelectedOrAll;
  EXPECT_EQ(mend::hole_regions(mend::Scan(scan), o).size(), 2u);
  scan.face_selected = faces_where(scan, [](const Vec3& c) { return c.x() > 0.8; });
  ASSERT_EQ(mend::hole_regions(mend::Scan(scan), o).size(), 1u);
  EXPECT_GT(mend::hole_regions(mend::Scan(scan), o)[0].box.center().x(), 0);
  scan.face_selected = faces_where(scan, [](const Vec3& c) { return std::abs(c.x()) < 0.2; });  // beside none
  EXPECT_EQ(mend::hole_regions(mend::Scan(scan), o).size(), 2u);
}

TEST(Region, LeavesOutHolesOfMoreEdges) {
  const Mesh whole = sphere();
  const Mesh scan =
      mesh::take_faces(whole, faces_where(whole, [](const Vec3& c) { return c.x() < 0.95 && c.x() > -0.7; }));
  mend::RegionOptions o;
  o.by = mend::RegionBy::SelectedOrAll;
  std::vector<mend::Region> all = mend::hole_regions(mend::Scan(scan), o);
  ASSERT_EQ(all.size(), 2u);
  o.largest_hole = all[1].rims[0].size();
  ASSERT_EQ(mend::hole_regions(mend::Scan(scan), o).size(), 1u);
  o.largest_hole -= 1;
  EXPECT_NE(user_error([&] { mend::hole_regions(mend::Scan(scan), o); }).find("left out"), std::string::npos);
}

/// A flat grid of n x n squares.
Mesh flat_grid(int n) {
  Mesh m;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) m.vertices.emplace_back(i, j, 0);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, b = a + n + 1;
      m.faces.push_back({a, b, b + 1}), m.faces.push_back({a, b + 1, a + 1});
    }
  return m;
}

TEST(Region, ManyFlecksCostNoMoreThanTheirFaces) {
  Mesh m = flat_grid(400);
  m.face_selected.assign(m.faces.size(), 0);
  for (int i = 2; i < 400; i += 4)
    for (int j = 2; j < 400; j += 4) m.face_selected[2 * (400 * i + j)] = 1;
  Progress silent;
  mend::RegionOptions near;
  near.margin = 0.5;
  const mend::Scan scan(m);
  const std::vector<mend::Region> regions = mend::flaw_regions(scan, near, silent);
  EXPECT_EQ(regions.size(), 10000u);
  std::size_t faces = 0;
  for (const mend::Region& r : regions) faces += r.flaw.size();
  EXPECT_EQ(faces, 10000u);
  // Each reaches the next: all are one.
  near.margin = 4;
  EXPECT_EQ(mend::flaw_regions(scan, near, silent).size(), 1u);
  Progress no([](int, const char*) { return false; });
  EXPECT_THROW(mend::flaw_regions(scan, near, no), Cancelled);
}

TEST(Region, FlecksThatReachEachOtherByWayOfAThirdAreOne) {
  Mesh m = flat_grid(40);
  m.face_selected.assign(m.faces.size(), 0);
  for (int i : {0, 3, 6, 30}) m.face_selected[2 * (40 * i + 20)] = 1;
  mend::RegionOptions o;
  o.margin = 2.5;
  Progress silent;
  const std::vector<mend::Region> regions = mend::flaw_regions(mend::Scan(m), o, silent);
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[0].flaw.size(), 3u);
  EXPECT_EQ(regions[1].flaw.size(), 1u);
}

TEST(Region, ASelectionThroughTheModelMeansItsFront) {
  // A dented ball around another one; the selection goes through both, to the back.
  Mesh m = together({noisy_sphere(Vec3::Zero(), 1, 4, 0, 1), sphere(Vec3::Zero(), 0.8, 3)});
  const int outer = 20 * 256;
  for (Vec3& p : m.vertices)
    if (p.z() > 0.9 && p.norm() > 0.9) p *= 1 - 0.1 * std::sin(40 * p.x());
  m.face_selected = faces_where(m, [](const Vec3& c) { return c.head<2>().norm() < 0.3; });
  Progress silent;
  mend::RegionOptions o;
  o.margin = 3;  // all are together
  const std::vector<mend::Region> regions = mend::flaw_regions(mend::Scan(m), o, silent);
  ASSERT_EQ(regions.size(), 1u);
  const std::size_t selected = std::size_t(std::count(m.face_selected.begin(), m.face_selected.end(), 1));
  EXPECT_EQ(regions[0].flaw.size() + regions[0].not_meant.size(), selected);
  EXPECT_GT(regions[0].flaw.size(), 20u);
  for (int f : regions[0].flaw) {
    EXPECT_LT(f, outer);
    EXPECT_GT(m.center(f).z(), 0);
  }
  // Flecks side by side are all meant.
  m.face_selected =
      faces_where(m, [](const Vec3& c) { return c.norm() > 0.9 && c.z() > 0.5 && std::abs(c.x()) > 0.05; });
  const std::vector<mend::Region> beside = mend::flaw_regions(mend::Scan(m), o, silent);
  ASSERT_EQ(beside.size(), 1u);
  EXPECT_TRUE(beside[0].not_meant.empty());
}

TEST(Region, TheFarSideOfASelectionIsNotMeant) {
  // A ball with a dent, and a rectangle drawn around it, which takes the far side as well.
  Mesh m = sphere(Vec3::Zero(), 1, 5);
  for (Vec3& p : m.vertices)
    if (const double d = (p - Vec3::UnitZ()).norm(); d < 0.25) p *= 1 - 0.1 * std::cos(d / 0.25 * M_PI / 2);
  const auto in_rectangle = [](const Vec3& c) { return std::abs(c.x()) < 0.3 && std::abs(c.y()) < 0.2; };
  m.face_selected = faces_where(m, in_rectangle);
  Progress silent;
  std::vector<mend::Region> regions = mend::flaw_regions(mend::Scan(m), {}, silent);
  ASSERT_EQ(regions.size(), 1u);
  EXPECT_GT(regions[0].box.min().z(), 0);
  EXPECT_GT(regions[0].not_meant.size(), 50u);
  // Dented there too, it is a flaw of its own; so is one of another outline.
  Mesh both = m;
  for (Vec3& p : both.vertices)
    if (const double d = (p + Vec3::UnitZ()).norm(); d < 0.25) p *= 1 - 0.1 * std::cos(d / 0.25 * M_PI / 2);
  EXPECT_EQ(mend::flaw_regions(mend::Scan(both), {}, silent).size(), 2u);
  m.face_selected =
      faces_where(m, [&](const Vec3& c) { return in_rectangle(c) && (c.z() > 0 || c.head<2>().norm() < 0.1); });
  EXPECT_EQ(mend::flaw_regions(mend::Scan(m), {}, silent).size(), 2u);
}

/// A sphere slit from pole to pole, as at the seam of a texture, its sides rounded apart.
Mesh slit_sphere(double apart) {
  Mesh m = sphere(Vec3::Zero(), 1, 4);
  const int n = m.vertex_count();
  std::vector<int> copy(m.vertices.size(), -1);
  for (int v = 0; v < n; ++v)
    if (std::abs(m.vertices[v].x()) < 1e-9 && m.vertices[v].y() > 0.1) {
      copy[v] = m.vertex_count();
      m.vertices.push_back(m.vertices[v] + apart * Vec3(1, -1, 1));
    }
  for (int f = 0; f < m.face_count(); ++f)
    if (m.center(f).x() > 0)
      for (int& v : m.faces[f])
        if (copy[v] >= 0) v = copy[v];
  for (Vec3& p : m.vertices)
    for (int d = 0; d < 3; ++d) p[d] = float(std::round(p[d] * 1e6) / 1e6);
  return m;
}

TEST(Scan, SlitsAreNoHoles) {
  for (double apart : {0.0, 1e-6, 3e-6}) {
    const Mesh slit = slit_sphere(apart);
    ASSERT_GT(mesh::check(slit).boundary_edges, 20);
    const mend::Scan scan(slit);
    EXPECT_TRUE(scan.rims().empty()) << apart;
    EXPECT_TRUE(mesh::check(scan.mesh()).manifold());
    EXPECT_EQ(scan.mesh().face_count(), slit.face_count());
  }
  EXPECT_FALSE(mend::Scan(slit_sphere(1e-3)).rims().empty());  // gaps that one can see
}

TEST(Scan, StepsOfCoordinates) {
  EXPECT_NEAR(mesh::coordinate_step(slit_sphere(0)), 1e-6, 1e-12);
  EXPECT_EQ(mesh::coordinate_step(flat_grid(4)), 1);
  EXPECT_LT(mesh::coordinate_step(sphere()), 2e-7);
  EXPECT_EQ(mesh::coordinate_step({}), 0);
  // Whole numbers a step apart are no slit.
  Mesh holed = flat_grid(8);
  holed.faces.erase(holed.faces.begin() + 2 * (8 * 4 + 4));
  EXPECT_EQ(mend::Scan(holed).rims().size(), 2u);
}

}  // namespace
}  // namespace parts::test
