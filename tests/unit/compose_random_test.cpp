// SPDX-License-Identifier: GPL-3.0-or-later
#include "unit/compose_support.h"

namespace parts::test {
namespace {

/// What a user is promised of every composition of closed models.
struct Tally {
  int scenes = 0, clean = 0, refused = 0;
};

void compose_random_scenes(cut::Cut cut, unsigned from, unsigned to, Tally& tally) {
  for (unsigned seed = from; seed < to; ++seed) {
    const std::string what = "random_scene(" + std::to_string(seed) + ")";
    const Scene scene = random_scene(seed);
    const cut::Part a{scene.a, scene.keep_a}, b{scene.b, scene.keep_b};
    compose::ComposeOptions options;
    options.cut = cut;
    options.resolution = seed % 3 == 0 ? 30 + int(seed % 40) : 0;
    ++tally.scenes;
    compose::ComposeResult r;
    try {
      r = compose_quietly(a, b, options);
    } catch (const UserError&) {
      ++tally.refused;
      continue;
    }
    expect_closed_manifold(r.composed, what);
    EXPECT_EQ(r.face_from_b.size(), r.composed.faces.size()) << what;
    EXPECT_EQ(missing_faces(r, a, b), 0) << what;
    EXPECT_EQ(r.report.loops_open, 0) << what;
    // Crossed faces are split, and their neighbours at the same edges.
    const double near = 8 * r.report.seam_edge + 2 * std::max(longest_edge(a.mesh), longest_edge(b.mesh));
    EXPECT_EQ(changed_far_faces(r, a.mesh, b.mesh, near), 0) << what;
    // Every component that the cut makes ends at a contour, joined or capped.
    EXPECT_LE(mesh::check(r.composed).components, 2 + r.report.loops_a + r.report.loops_b) << what;
    EXPECT_GE(r.report.seconds, r.report.cut_seconds) << what;
    const long had = mesh::self_intersections(a.mesh) + mesh::self_intersections(b.mesh);
    tally.clean += mesh::self_intersections(r.composed, had + 1) <= had;
  }
}

TEST(ComposeRandom, MeshKeepsItsPromises) {
  Tally tally;
  compose_random_scenes(cut::Cut::Mesh, 0, 70, tally);
  RecordProperty("without_new_self_intersections", tally.clean);
  EXPECT_LE(tally.refused, 2);
  // Scenes are turned at random; the cut cannot join all of them without a fold. As many as on 2026-11-25.
  EXPECT_GE(tally.clean, 68);
}

TEST(ComposeRandom, ThesisKeepsItsPromises) {
  Tally tally;
  compose_random_scenes(cut::Cut::Thesis, 0, 30, tally);
  RecordProperty("without_new_self_intersections", tally.clean);
  EXPECT_LE(tally.refused, 2);
  EXPECT_GE(tally.clean, 23);  // as many as on 2026-11-25
}

TEST(ComposeRandom, TheSameBytesForAnyNumberOfThreads) {
  for (unsigned seed = 200; seed < 206; ++seed) {
    const Scene scene = random_scene(seed);
    compose::ComposeOptions options;
    options.cut = seed % 2 ? cut::Cut::Thesis : cut::Cut::Mesh;
    options.transition_surface = true;
    std::vector<compose::ComposeResult> results;
    for (const int threads : {1, 2, 8}) {
      options.threads = threads;
      results.push_back(compose_quietly({scene.a, scene.keep_a}, {scene.b, scene.keep_b}, options));
    }
    for (std::size_t i = 1; i < results.size(); ++i) {
      EXPECT_EQ(results[i].composed.vertices, results[0].composed.vertices) << seed;
      EXPECT_EQ(results[i].composed.faces, results[0].composed.faces) << seed;
      EXPECT_EQ(results[i].face_from_b, results[0].face_from_b) << seed;
      EXPECT_EQ(results[i].clipped_a.vertices, results[0].clipped_a.vertices) << seed;
      EXPECT_EQ(results[i].clipped_b.faces, results[0].clipped_b.faces) << seed;
      EXPECT_EQ(results[i].transition.vertices, results[0].transition.vertices) << seed;
      EXPECT_EQ(results[i].report.cut_cost, results[0].report.cut_cost) << seed;
    }
  }
}

}  // namespace
}  // namespace parts::test
