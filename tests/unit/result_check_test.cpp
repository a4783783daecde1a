// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/result_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "parts/mesh/attributes.h"
#include "parts/mesh/slits.h"
#include "support/shapes.h"

namespace parts {
namespace {

using namespace parts::test;
using mesh::measure_surface;
using mesh::ResultRules;
using mesh::SurfaceFigures;

Mesh moved(Mesh m, const Vec3& by) {
  for (Vec3& p : m.vertices) p += by;
  return m;
}

Mesh both(Mesh a, const Mesh& b) {
  mesh::append(a, b);
  return a;
}

Mesh without_faces(Mesh m, int from, int to) {
  m.faces.erase(m.faces.begin() + from, m.faces.begin() + to);
  return m;
}

/// Each face with corners of its own.
Mesh soup(const Mesh& m) {
  Mesh out;
  for (int f = 0; f < m.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) out.vertices.push_back(m.corner(f, k));
    out.faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return out;
}

std::string worse(const Mesh& result, const std::vector<Mesh>& inputs, const ResultRules& rules = {}) {
  std::vector<SurfaceFigures> before;
  for (const Mesh& m : inputs) before.push_back(measure_surface(m));
  return mesh::worse_than_inputs(measure_surface(result), before, rules);
}

TEST(ResultCheck, FiguresOfASoundSolid) {
  for (const Mesh& m : {sphere(), soup(sphere())}) {
    const SurfaceFigures s = measure_surface(m);
    EXPECT_EQ(s.pieces, 1);
    EXPECT_EQ(s.borders, 0);
    EXPECT_TRUE(s.nonmanifold.empty() && s.pinches.empty() && s.flipped.empty() && s.crossings.empty());
    EXPECT_EQ(s.nonfinite, 0);
    EXPECT_NEAR(s.volume, 4.19, 0.05);
    EXPECT_NEAR(s.roundest, s.volume, 0.05);
  }
}

TEST(ResultCheck, TheVolumeOfAnOpenSurfaceDoesNotDependOnItsPlace) {
  const Mesh bowl = without_faces(sphere(), 0, 300);
  const double volume = measure_surface(bowl).volume;
  EXPECT_GT(volume, 1);
  EXPECT_NEAR(measure_surface(moved(bowl, {1e4, -3e4, 2e4})).volume, volume, 1e-6);
}

TEST(ResultCheck, NothingIsWorseInTheInputItself) {
  const Mesh flawed = both(without_faces(sphere(), 3, 5), moved(sphere(), {1, 0.1, 0}));
  EXPECT_GT(measure_surface(flawed).crossings.size(), 10u);
  EXPECT_EQ(worse(flawed, {flawed}), "");
  EXPECT_EQ(worse(soup(flawed), {flawed}), "");
  EXPECT_EQ(worse(sphere(), {}), "");
}

TEST(ResultCheck, PiecesAndBorders) {
  const Mesh a = sphere(), b = moved(sphere(), {5, 0, 0});
  ResultRules joins, free;
  joins.joins = true, free.may_part = free.may_open = true;
  EXPECT_EQ(worse(both(a, b), {a, b}), "");
  EXPECT_EQ(worse(both(a, b), {a, b}, joins), "2 pieces where 1 would do");
  EXPECT_EQ(worse(a, {a, b}, joins), "");
  EXPECT_EQ(worse(both(without_faces(a, 7, 8), b), {a}), "2 pieces where 1 would do and 1 open border");
  EXPECT_EQ(worse(both(without_faces(a, 7, 8), b), {a}, free), "");
  EXPECT_EQ(worse(without_faces(a, 7, 8), {without_faces(a, 70, 71)}), "") << "as many as before";
}

TEST(ResultCheck, EdgesOfMoreThanTwoFaces) {
  const auto with_fin = [](int face) {
    Mesh m = sphere();
    m.vertices.push_back(1.2 * m.center(face));
    m.faces.push_back({m.faces[face][0], m.faces[face][1], m.vertex_count() - 1});
    return m;
  };
  const Mesh fin = with_fin(0), elsewhere = with_fin(90);
  EXPECT_EQ(measure_surface(fin).nonmanifold.size(), 1u);
  EXPECT_EQ(worse(soup(fin), {sphere()}), "1 open border and 1 edge of more than two faces");
  // A flaw that goes does not pay for one that comes.
  EXPECT_NE(worse(elsewhere, {fin}).find("1 edge of more than two faces"), std::string::npos);
  ResultRules by_number;
  by_number.moved = true;
  EXPECT_EQ(worse(elsewhere, {fin}, by_number).find("more than two faces"), std::string::npos);
}

TEST(ResultCheck, FlippedNeighboursAndTheInsideOut) {
  Mesh flipped = sphere();
  std::swap(flipped.faces[5][0], flipped.faces[5][1]);
  EXPECT_EQ(measure_surface(flipped).flipped.size(), 3u);
  EXPECT_EQ(worse(flipped, {sphere()}), "3 edges between faces that look opposite ways");
  Mesh inside_out = sphere();
  mesh::flip_orientation(inside_out);
  EXPECT_EQ(worse(inside_out, {sphere()}), "its inside out");
  EXPECT_EQ(worse(inside_out, {inside_out}), "");
  EXPECT_EQ(worse(without_faces(inside_out, 0, 200), {without_faces(sphere(), 0, 200)}), "its inside out");
}

TEST(ResultCheck, ASheetThatIsBentTheOtherWayIsNotInsideOut) {
  const auto bent = [](double by) {
    Mesh sheet = box({-1, -1, 0}, {1, 1, 0.1}, 8);
    sheet = mesh::take_faces(sheet, faces_where(sheet, [](const Vec3& c) { return c.z() > 0.0999; }));
    for (Vec3& p : sheet.vertices) p.z() = by * p.x() * p.x();
    return sheet;
  };
  EXPECT_LT(measure_surface(bent(-0.2)).volume * measure_surface(bent(0.2)).volume, 0);
  EXPECT_EQ(worse(bent(0.2), {bent(-0.2)}), "");
  EXPECT_EQ(worse(bent(-0.2), {bent(0.2)}), "");
}

TEST(ResultCheck, PlacesWhereItTouchesItself) {
  const Mesh a = box({0, 0, 0}, {1, 1, 1}), b = box({1, 1, 1}, {2, 2, 2});
  const SurfaceFigures s = measure_surface(both(a, b));
  EXPECT_EQ(s.pinches.size(), 1u);
  EXPECT_EQ(s.pieces, 2);
  EXPECT_EQ(worse(both(a, b), {a, b}), "1 vertex in which it touches itself");
  ResultRules open;
  open.may_open = true;
  EXPECT_EQ(worse(both(a, b), {a, b}, open), "");
}

TEST(ResultCheck, CrossingFaces) {
  const Mesh a = sphere(), b = moved(sphere(), {1, 0, 0});
  EXPECT_NE(worse(both(a, b), {a, b}).find("pairs of crossing faces"), std::string::npos);
  EXPECT_EQ(measure_surface(both(a, b), 1).crossings, measure_surface(both(a, b), 5).crossings);
}

/// Parts that lie beside each other, the first so many faces one of them.
std::string worse_parts(const Mesh& result, int first, const std::vector<Mesh>& inputs) {
  std::vector<char> part(result.faces.size(), 1);
  std::fill(part.begin(), part.begin() + first, 0);
  std::vector<SurfaceFigures> before;
  for (const Mesh& m : inputs) before.push_back(measure_surface(m));
  return mesh::worse_than_inputs(mesh::measure_parts(result, part), before, {});
}

TEST(ResultCheck, PartsMayCrossAndTouchButEachIsChecked) {
  const Mesh a = sphere(), b = moved(sphere(), {1, 0, 0});
  EXPECT_EQ(worse_parts(both(a, b), a.face_count(), {a, b}), "");
  const Mesh left = box({0, 0, 0}, {1, 1, 1}), right = box({1, 0, 0}, {2, 1, 1});  // they share a side
  EXPECT_NE(worse(both(left, right), {left, right}).find("edges of more than two faces"), std::string::npos);
  EXPECT_EQ(worse_parts(both(left, right), left.face_count(), {left, right}), "");
  Mesh fin = left;
  fin.vertices.push_back({0.5, 0.5, 3});
  fin.faces.push_back({fin.faces[0][0], fin.faces[0][1], fin.vertex_count() - 1});
  EXPECT_NE(worse_parts(both(fin, right), fin.face_count(), {left, right}).find("1 edge of more than two faces"),
            std::string::npos);
  const Mesh crossed = both(a, b);
  EXPECT_NE(worse_parts(both(crossed, right), crossed.face_count(), {a, b, right}).find("crossing faces"),
            std::string::npos);
}

TEST(ResultCheck, RoundingAtASlitMovesKnownFlaws) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> off(-1.5e-6, 1.5e-6);
  Mesh crossed = soup(both(sphere(), moved(sphere(), {1, 0, 0})));
  for (Vec3& p : crossed.vertices)
    for (int k = 0; k < 3; ++k) p[k] = std::round((p[k] + off(random)) * 1e6) / 1e6;
  const Mesh mended = mesh::prepare_without_slits(crossed);
  SurfaceFigures before = measure_surface(crossed);
  const SurfaceFigures result = measure_surface(mended);
  EXPECT_NE(mesh::worse_than_inputs(result, {before}, {}), "");
  mesh::add_flaws(result, before);
  EXPECT_EQ(mesh::worse_than_inputs(result, {before}, {}), "");
  const Mesh more = both(mended, moved(sphere(), {1.5, 0, 0}));
  EXPECT_NE(mesh::worse_than_inputs(measure_surface(more), {before}, {}).find("crossing faces"), std::string::npos);
}

TEST(ResultCheck, CoordinatesThatAreNoNumbers) {
  Mesh m = sphere();
  m.vertices[m.faces[0][0]].x() = NAN;
  EXPECT_GE(measure_surface(m).nonfinite, 5);
  EXPECT_NE(worse(m, {sphere()}).find("with a coordinate that is no number"), std::string::npos);
  EXPECT_EQ(measure_surface(Mesh()).pieces, 0);
}

TEST(ResultCheck, SinglePrecisionIsWhatTheHostHas) {
  Mesh m;
  m.vertices = {{0.1, 1 / 3., -1e-7}};
  m = mesh::in_single_precision(m);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(m.vertices[0][k], double(float((Vec3(0.1, 1 / 3., -1e-7))[k])));
}

TEST(ResultCheck, ArraysThatDoNotFit) {
  EXPECT_NO_THROW(mesh::check_arrays(sphere()));
  Mesh m = sphere();
  m.faces[3][1] = m.vertex_count();
  EXPECT_THROW(mesh::check_arrays(m), std::logic_error);
  m = sphere();
  m.vertex_color.resize(7);
  EXPECT_THROW(mesh::check_arrays(m), std::logic_error);
  m = sphere();
  m.wedges.resize(m.faces.size());
  EXPECT_NO_THROW(mesh::check_arrays(m));
  m.wedges[0].texture = 0;
  EXPECT_THROW(mesh::check_arrays(m), std::logic_error);
}

}  // namespace
}  // namespace parts
