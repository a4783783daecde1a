// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <filesystem>

#include "compose_support.h"
#include "parts/io/mesh_io.h"
#include "parts/mend/mend.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/prepare.h"
#include "parts/spatial/closest_face.h"
#include "support/busts.h"

namespace parts::test {
namespace {

constexpr int kCells = 36;

std::vector<mend::PlacedModel> other_busts(int count) {
  static std::vector<mend::PlacedModel> models;  // made once
  for (int i = int(models.size()); i < count; ++i)
    models.push_back({bust_mesh(random_bust(unsigned(20 + i)), "other.png", kCells), "bust " + std::to_string(i)});
  return {models.begin(), models.begin() + count};
}

const Mesh& own_bust() {
  static const Mesh bust = bust_mesh(random_bust(3), "own.png", kCells);  // made once
  return bust;
}

/// A bust much like own_bust().
const std::vector<mend::PlacedModel>& similar_bust() {
  static std::vector<mend::PlacedModel> models;
  if (models.empty()) {
    BustShape shape = random_bust(3);
    shape.nose_width *= 1.1, shape.nose_forward *= 0.92, shape.head_width *= 1.04, shape.jaw_width *= 1.05;
    shape.cheek *= 0.8, shape.brow *= 1.2;
    models.push_back({bust_mesh(shape, "other.png", kCells), "similar"});
  }
  return models;
}

double rms(const std::vector<Vec3>& points, const Mesh& surface) {
  const spatial::ClosestFace closest(surface);
  double sum = 0;
  for (const Vec3& p : points) sum += std::pow(closest(p).distance, 2);
  return std::sqrt(sum / double(points.size()));
}

std::vector<Vec3> within(const Mesh& mesh, const Vec3& center, double radius) {
  std::vector<Vec3> points;
  for (const Vec3& v : mesh.vertices)
    if ((v - center).norm() < radius) points.push_back(v);
  return points;
}

/// Faces of a mesh that the result does not have, bit for bit.
int missing(const Mesh& mesh, const Mesh& result, const std::function<bool(int)>& counts) {
  const std::set<FaceKey> keys = face_keys(result);
  int n = 0;
  for (int f = 0; f < mesh.face_count(); ++f) n += counts(f) && !keys.count(face_key(mesh, f));
  return n;
}

mend::RegionOptions around_holes() {
  mend::RegionOptions o;
  o.by = mend::RegionBy::Holes;
  return o;
}

mend::Restored fill_quietly(const Mesh& scan, const std::vector<mend::PlacedModel>& models,
                            const mend::RestoreOptions& options = {},
                            const mend::RegionOptions& where = around_holes()) {
  Progress silent;
  return mend::fill_hole(scan, mend::hole_regions(scan, where).at(0), models, options, silent);
}

struct NoseHole {
  BustShape shape = random_bust(3);
  const Mesh& whole = own_bust();
  Vec3 tip = bust_landmarks(shape).nose_tip;
  Mesh scan = mesh::prepare(without_ball(whole, tip, 0.16)).mesh;
};

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
  plain.fit_to_rim = false;
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
    if (r.face_from_model[f] < 2) {
      EXPECT_EQ(r.mesh.wedges[f].texture, r.face_from_model[f]);
      (r.face_from_model[f] ? other : own)++;
      if (!r.face_from_model[f]) {
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
  one.threads = 1, three.threads = 3;
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
  mend::RegionOptions where = around_holes();
  Progress silent;
  const std::vector<mend::Region> regions = mend::hole_regions(n.scan, where);
  ASSERT_EQ(regions.size(), 1u);  // the piece's own outline is no hole
  const mend::Restored r = mend::fill_hole(n.scan, regions[0], other_busts(1), {}, silent);
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
  const std::vector<mend::Region> regions = mend::flaw_regions(s.scan, {});
  ASSERT_EQ(regions.size(), 1u);
  const mend::Restored r = mend::restore_surface(s.scan, regions[0], similar_bust(), {}, silent);
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
  Progress silent;
  for (double share : {0.15, 0.3, 0.45}) {
    mend::RestoreOptions o;
    o.constraint_distance = share;
    const mend::Restored r =
        mend::restore_surface(s.scan, mend::flaw_regions(s.scan, where).at(0), similar_bust(), o, silent);
    expect_closed_manifold(r.mesh, "restored in a box");
    EXPECT_LT(rms(truth, r.mesh), 0.6 * rms(truth, s.scan)) << share;
  }
}

TEST(Restore, ByTheCutOfTheThesisOrASentence) {
  const Scarred s;
  mend::RegionOptions where;
  where.by = mend::RegionBy::Box;
  where.box = Box(s.at - Vec3(0.24, 0.24, 0.24), s.at + Vec3(0.24, 0.24, 0.24));
  mend::RestoreOptions o;
  o.cut = cut::Cut::Thesis;
  Progress silent;
  mend::Restored r;
  const std::string sentence = user_error(
      [&] { r = mend::restore_surface(s.scan, mend::flaw_regions(s.scan, where).at(0), similar_bust(), o, silent); });
  if (sentence.empty()) {
    expect_closed_manifold(r.mesh, "the cut of the thesis");
  } else {
    EXPECT_NE(sentence.find("choose"), std::string::npos) << sentence;
  }
}

TEST(Mend, ClosesHolesTooSmallForAnyDetailWithoutASearch) {
  Mesh scan = sphere();
  std::vector<char> stays(scan.faces.size(), 1);
  const int v = scan.faces[100][0];  // a whole fan goes, and a face elsewhere
  for (int f = 0; f < scan.face_count(); ++f)
    for (int u : scan.faces[f]) stays[f] = stays[f] && u != v;
  stays[900] = 0;
  scan = mesh::take_faces(scan, stays);
  ASSERT_EQ(mesh::check(scan).boundary_loops, 2);
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "mend_models";
  std::filesystem::create_directories(folder);
  io::write_mesh(sphere(), (folder / "sphere.ply").string());
  Progress silent;
  const io::ModelDatabase database(folder.string(), silent);
  mend::MendOptions o;
  o.fill = true;
  o.region.by = mend::RegionBy::Holes;
  const mend::Mended m = mend::mend_scan(scan, database, o, silent);
  EXPECT_EQ(m.mended, 2);
  EXPECT_TRUE(m.candidates.empty());
  expect_closed_manifold(m.mesh, "sphere");
}

TEST(Mend, FillsAHoleWithATornRim) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("mend_torn_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  io::write_mesh(similar_bust()[0].mesh, (folder / "similar.ply").string());
  // By one corner alone: teeth that hang together in vertices, and crumbs.
  const Mesh whole = mesh::prepare(own_bust()).mesh;
  const Vec3 at = bust_landmarks(random_bust(3)).nose_tip;
  std::vector<char> stays(whole.faces.size());
  for (int f = 0; f < whole.face_count(); ++f) stays[f] = (whole.corner(f, 0) - at).norm() > 0.2;
  const Mesh scan = mesh::take_faces(whole, stays);
  ASSERT_GT(mesh::check(scan).nonmanifold_vertices, 0);
  Progress silent;
  mend::MendOptions options;
  options.fill = true;
  options.region = around_holes();
  const io::ModelDatabase database(folder.string(), silent);
  const mend::Mended mended = mend::mend_scan(scan, database, options, silent);
  const mesh::MeshCheck c = mesh::check(mended.mesh);
  EXPECT_TRUE(c.manifold());
  EXPECT_EQ(c.boundary_edges, 0);
  EXPECT_EQ(c.components, 1);
  fs::remove_all(folder);
}

TEST(Region, OneForEachFlaw) {
  Mesh m = sphere();
  m.face_selected = faces_where(m, [](const Vec3& c) { return std::abs(c.x()) > 0.95; });
  EXPECT_EQ(mend::flaw_regions(m, {}).size(), 2u);
}

TEST(Region, HolesLeftOutBySizeAndBySelection) {
  const Mesh whole = sphere();
  std::vector<char> stays = faces_where(whole, [](const Vec3& c) { return c.x() < 0.95 && c.x() > -0.7; });
  Mesh scan = mesh::take_faces(whole, stays);
  mend::RegionOptions o = around_holes();
  EXPECT_EQ(mend::hole_regions(scan, o).size(), 2u);
  o.longest_rim = 3;
  EXPECT_EQ(mend::hole_regions(scan, o).size(), 1u);
  o.longest_rim = 0;
  scan.face_selected = faces_where(scan, [](const Vec3& c) { return c.x() < -0.6; });
  ASSERT_EQ(mend::hole_regions(scan, o).size(), 1u);
  EXPECT_GT(mend::hole_regions(scan, o)[0].box.center().x(), 0);
  o.by = mend::RegionBy::Selection;
  ASSERT_EQ(mend::hole_regions(scan, o).size(), 1u);
  EXPECT_LT(mend::hole_regions(scan, o)[0].box.center().x(), 0);
}

TEST(Region, SaysWhatIsMissing) {
  const Mesh closed = sphere();
  mend::RegionOptions o = around_holes();
  EXPECT_NE(user_error([&] { mend::hole_regions(closed, o); }).find("no hole"), std::string::npos);
  EXPECT_NE(user_error([&] { mend::flaw_regions(closed, {}); }).find("No face is selected"), std::string::npos);
  o.by = mend::RegionBy::Box;
  o.box = Box(Vec3(5, 5, 5), Vec3(6, 6, 6));
  EXPECT_NE(user_error([&] { mend::flaw_regions(closed, o); }).find("no surface"), std::string::npos);
  o.box = Box(Vec3(1, 1, 1), Vec3(-1, -1, -1));
  EXPECT_NE(user_error([&] { mend::flaw_regions(closed, o); }).find("no thickness"), std::string::npos);
  EXPECT_NE(user_error([&] { mend::flaw_regions(Mesh(), o); }).find("no face"), std::string::npos);
}

}  // namespace
}  // namespace parts::test
