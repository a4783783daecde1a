// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "mend_support.h"

namespace parts::test {
namespace {

TEST(FillHole, ClosesANoseHoleAndKeepsEveryFaceOfTheScan) {
  const NoseHole n;
  ASSERT_GT(mesh::check(n.scan).boundary_edges, 0);
  const mend::Restored r = fill_quietly(n.scan, other_busts(3));
  expect_closed_manifold(r.mesh, "filled bust");
  EXPECT_EQ(missing(n.scan, r.mesh, [](int) { return true; }), 0);
  EXPECT_EQ(r.report.rims_joined, 1);
  EXPECT_EQ(r.report.faces_replaced, 0);
  // Nearer to what was there than a flat lid.
  Mesh lid = n.scan;
  const std::vector<mesh::Loop> rims = mend::find_rims(lid);
  Vec3 middle = Vec3::Zero();
  for (int v : rims[0].vertices) middle += lid.vertices[v] / rims[0].size();
  lid.vertices.push_back(middle);
  for (int i = 0; i < rims[0].size(); ++i)
    lid.faces.push_back({rims[0].vertices[(i + 1) % rims[0].size()], rims[0].vertices[i], lid.vertex_count() - 1});
  const std::vector<Vec3> truth = within(n.whole, n.tip, 0.14);
  EXPECT_LT(rms(truth, r.mesh), 0.7 * rms(truth, lid));
}

TEST(FillHole, FittingToTheRimIsCloserThanPastingAsItIs) {
  const NoseHole n;
  const std::vector<Vec3> truth = within(n.whole, n.tip, 0.14);
  mend::RestoreOptions plain;
  plain.fitting.fit_to_rim = false;
  const std::vector<mend::PlacedModel> models = other_busts(1);
  const mend::Restored fitted = fill_quietly(n.scan, models), pasted = fill_quietly(n.scan, models, plain);
  expect_closed_manifold(pasted.mesh, "pasted as it is");
  EXPECT_LT(rms(truth, fitted.mesh), rms(truth, pasted.mesh));
  EXPECT_LT(fitted.report.rms_after, 0.3 * fitted.report.rms_before);
}

TEST(FillHole, CarriesColoursAndTexturesOver) {
  NoseHole n;
  n.scan.face_color.assign(n.scan.faces.size(), {1, 2, 3, 255});
  const mend::Restored r = fill_quietly(n.scan, other_busts(1));
  ASSERT_EQ(r.mesh.textures.size(), 2u);
  int own = 0, other = 0;
  for (int f = 0; f < r.mesh.face_count(); ++f)
    if (const int made_by = maker(r.source[f]); made_by < 2) {
      EXPECT_EQ(r.mesh.wedges[f].texture, made_by);
      (made_by ? other : own)++;
      if (!made_by) {
        EXPECT_EQ(r.mesh.face_color[f], (Color{1, 2, 3, 255}));
      }
    }
  EXPECT_EQ(own, n.scan.face_count());
  EXPECT_GT(other, 100);
}

TEST(FillHole, IsTheSameForAnyNumberOfThreads) {
  const NoseHole n;
  const std::vector<mend::PlacedModel> models = other_busts(1);
  mend::RestoreOptions one, three;
  one.fitting.threads = 1, three.fitting.threads = 3;
  const mend::Restored a = fill_quietly(n.scan, models, one), b = fill_quietly(n.scan, models, three);
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.faces, b.mesh.faces);
}

TEST(FillHole, DropsLoosePiecesInTheHole) {
  NoseHole n;
  std::vector<char> piece(n.whole.faces.size());
  for (int f = 0; f < n.whole.face_count(); ++f)
    piece[f] = (n.whole.corner(f, 0) - n.tip - Vec3(0, 0.06, -0.02)).norm() < 0.035;
  mesh::append(n.scan, mesh::take_faces(n.whole, piece));
  ASSERT_EQ(mesh::check(n.scan).components, 2);
  ASSERT_EQ(mend::hole_regions(mend::Scan(n.scan), around_holes()).size(), 1u);  // the piece's own outline is no hole
  const mend::Restored r = fill_quietly(n.scan, other_busts(1));
  EXPECT_EQ(r.report.islands_dropped, 1);
  expect_closed_manifold(r.mesh, "filled around a loose piece");
}

TEST(FillHole, BridgesAGapInATube) {
  const Mesh whole = torus();
  std::vector<char> stays(whole.faces.size());
  for (int f = 0; f < whole.face_count(); ++f)
    stays[f] = !(whole.corner(f, 0).x() > 0.6 && std::abs(whole.corner(f, 0).y()) < 0.4);
  const Mesh scan = mesh::take_faces(whole, stays);
  ASSERT_EQ(mend::find_rims(scan).size(), 2u);
  Mesh model = torus(Vec3(0.02, 0, 0.01), 1.03, 0.36, 60, 30);
  const mend::Restored r = fill_quietly(scan, {{model, "torus"}});
  expect_closed_manifold(r.mesh, "torus");
  EXPECT_EQ(mesh::check(r.mesh).euler, 0);
  EXPECT_EQ(r.report.rims_joined, 2);
}

TEST(FillHole, SaysWhenTheModelIsOpenThereToo) {
  const NoseHole n;
  const Mesh open = without_ball(n.whole, n.tip, 0.22);
  const std::string sentence = user_error([&] { fill_quietly(n.scan, {{open, "open"}}); });
  EXPECT_NE(sentence.find("No model of the database"), std::string::npos) << sentence;
}

TEST(FillHole, TakesTheNextModelWhereTheFirstDoesNot) {
  const NoseHole n;
  std::vector<mend::PlacedModel> models = other_busts(1);
  models.insert(models.begin(), {moved(sphere(), Eigen::Affine3d(Eigen::Translation3d(50, 0, 0))), "far away"});
  const mend::Restored r = fill_quietly(n.scan, models);
  EXPECT_EQ(r.report.model, 1);
}

struct Scarred {
  BustShape shape = random_bust(3);
  const Mesh& whole = own_bust();
  Vec3 at = bust_landmarks(shape).nose_tip;
  std::vector<char> damaged;
  Mesh scan = gouged(whole, at, 0.14, 0.08, 7, &damaged);
};

TEST(Restore, ReplacesTheSelectedFlawAndNothingOutside) {
  Scarred s;
  s.scan.face_selected = s.damaged;
  Progress silent;
  const std::vector<mend::Region> regions = mend::flaw_regions(mend::Scan(s.scan), {}, silent);
  ASSERT_EQ(regions.size(), 1u);
  const mend::Restored r = restore_quietly(s.scan, {}, similar_bust());
  expect_closed_manifold(r.mesh, "restored bust");
  EXPECT_EQ(missing(s.scan, r.mesh, [&](int f) { return !regions[0].box.contains(s.scan.face_box(f)); }), 0);
  const std::set<FaceKey> keys = face_keys(r.mesh);
  int left = 0;
  for (int f = 0; f < s.scan.face_count(); ++f) left += s.damaged[f] && keys.count(face_key(s.scan, f));
  EXPECT_EQ(left, 0) << "damaged faces are still there";
  const std::vector<Vec3> truth = within(s.whole, s.at, 0.12);
  EXPECT_LT(rms(truth, r.mesh), 0.5 * rms(truth, s.scan));
}

TEST(Restore, FindsTheFlawInABox) {
  const Scarred s;
  mend::RegionOptions where;
  where.by = mend::RegionBy::Box;
  where.box = Box(s.at - Vec3(0.24, 0.24, 0.24), s.at + Vec3(0.24, 0.24, 0.24));
  const std::vector<Vec3> truth = within(s.whole, s.at, 0.12);
  for (double share : {0.15, 0.3, 0.45}) {
    mend::RestoreOptions o;
    o.constraint_distance = share;
    const mend::Restored r = restore_quietly(s.scan, where, similar_bust(), o);
    expect_closed_manifold(r.mesh, "restored in a box");
    EXPECT_LT(rms(truth, r.mesh), 0.6 * rms(truth, s.scan)) << share;
  }
}

TEST(Restore, ByTheCutOfTheThesis) {
  const Scarred s;
  mend::RegionOptions where;
  where.by = mend::RegionBy::Box;
  where.box = Box(s.at - Vec3(0.24, 0.24, 0.24), s.at + Vec3(0.24, 0.24, 0.24));
  mend::RestoreOptions o;
  o.cut = cut::Cut::Thesis;
  const mend::Restored r = restore_quietly(s.scan, where, similar_bust(), o);
  expect_closed_manifold(r.mesh, "the cut of the thesis");
  const std::vector<Vec3> truth = within(s.whole, s.at, 0.12);
  EXPECT_LT(rms(truth, r.mesh), 0.6 * rms(truth, s.scan));
  EXPECT_GT(r.report.faces_replaced, 0);
  EXPECT_EQ(s.scan.face_count() - r.report.faces_replaced + r.report.faces_added, r.mesh.face_count());
}

}  // namespace
}  // namespace parts::test
