// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/acceptance.h"

#include <gtest/gtest.h>

#include "parts/mesh/attributes.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

using mend::Objection;

/// A flat sheet with a hole of two by two squares, and patches for it.
struct Sheet {
  Mesh whole, before;
  std::vector<mesh::Loop> rims;
  Mesh after;
  std::vector<int> source;

  Sheet() {
    constexpr int n = 10;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) whole.vertices.emplace_back(i, j, 0);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const int a = i * (n + 1) + j, b = a + n + 1;
        whole.faces.push_back({a, b, b + 1}), whole.faces.push_back({a, b + 1, a + 1});
      }
    before = mesh::take_faces(
        whole, faces_where(whole, [](const Vec3& c) { return (c - Vec3(5, 5, 0)).cwiseAbs().maxCoeff() > 1; }));
    after = before;
    for (int f = 0; f < before.face_count(); ++f) source.push_back(f);
    for (const mesh::Loop& rim : mend::find_rims(before))
      if (rim.size() == 8) rims.push_back(rim);
  }
  void add(const Triangle& face) { after.faces.push_back(face), source.push_back(mend::kFromModel); }
  /// A fan from the rim to a point.
  void fill_towards(const Vec3& middle) {
    after.vertices.push_back(middle);
    for (int i = 0; i < 8; ++i) add({rims[0].next(i), rims[0].vertices[i], after.vertex_count() - 1});
  }
  Objection judged() const { return mend::objection_to({before, rims, after, source, whole, 0.5, 1}); }
};

TEST(Acceptance, OfAGoodPatch) {
  Sheet s;
  ASSERT_EQ(s.rims.size(), 1u);
  s.fill_towards(Vec3(5, 5, 0.1));
  EXPECT_EQ(s.judged(), Objection::None);
}

TEST(Acceptance, NotOfOneThatLeavesARimOpen) {
  Sheet s;
  EXPECT_EQ(s.judged(), Objection::Open);
  s.fill_towards(Vec3(5, 5, 0));
  s.after.faces.pop_back(), s.source.pop_back();
  EXPECT_EQ(s.judged(), Objection::Open);
}

TEST(Acceptance, NotOfOneThatIsPulledToAPoint) {
  Sheet s;
  s.fill_towards(Vec3(5, 5, 4));
  EXPECT_EQ(s.judged(), Objection::FarFromModel);
}

TEST(Acceptance, NotOfOneThatCrossesTheScan) {
  Sheet s;
  // A blade of the scan's own that stands in the hole.
  const int n = s.before.vertex_count();
  for (Mesh* m : {&s.before, &s.after})
    for (const Vec3& p : {Vec3(4.5, 4.4, -1), Vec3(5.5, 4.6, -1), Vec3(5.1, 4.5, 1)}) m->vertices.push_back(p);
  s.before.faces.push_back({n, n + 1, n + 2}), s.after.faces.push_back({n, n + 1, n + 2});
  s.source.push_back(s.before.face_count() - 1);
  s.fill_towards(Vec3(5, 5, 0));
  EXPECT_EQ(s.judged(), Objection::Crosses);
}

TEST(Acceptance, NotOfOneThatTouchesItselfOrTheScanInAVertex) {
  Sheet s;
  s.fill_towards(Vec3(5, 5, 0));
  const int n = s.after.vertex_count();  // a closed pyramid whose tip has the place of the fan's middle
  for (const Vec3& p : {Vec3(5, 5, 0), Vec3(4.9, 4.9, 0.2), Vec3(5.1, 4.9, 0.2), Vec3(5, 5.1, 0.2)})
    s.after.vertices.push_back(p);
  s.add({n, n + 2, n + 1}), s.add({n, n + 3, n + 2}), s.add({n, n + 1, n + 3}), s.add({n + 1, n + 2, n + 3});
  EXPECT_EQ(s.judged(), Objection::NonManifold);
}

TEST(Acceptance, WhatWasNoManifoldBeforeMayStaySo) {
  Sheet s;
  s.fill_towards(Vec3(5, 5, 0));
  const int n = s.before.vertex_count();  // another sheet that touches the scan's corner
  for (Mesh* m : {&s.before, &s.after}) {
    const int first = m->vertex_count();
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0)}) m->vertices.push_back(p);
    m->faces.push_back({first, first + 1, first + 2});
  }
  s.source.push_back(s.before.face_count() - 1);
  EXPECT_EQ(n + 3, s.before.vertex_count());
  EXPECT_EQ(s.judged(), Objection::None);
}

}  // namespace
}  // namespace parts::test
