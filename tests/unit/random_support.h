// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Random scenes: a scene is a few numbers, from which its input is made. One
// that breaks a promise is told by its seed and made simpler while it still does.

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "compose_support.h"
#include "parts/mesh/result_check.h"
#include "support/shapes.h"

namespace parts::test {

inline unsigned number_from(const char* variable, unsigned otherwise) {
  const char* text = std::getenv(variable);
  return text ? unsigned(std::strtoul(text, nullptr, 10)) : otherwise;
}

/// What became of the scenes of a kind.
struct SceneTally {
  int scenes = 0, refused = 0, doubted = 0, flawless = 0;
  /// Of those that had a result.
  double share(int n) const { return scenes > refused ? double(n) / (scenes - refused) : 1; }
};

/// The scenes with the seeds 0, 1, ... of a kind; by hand $PARTS_SCENES many, from
/// seed $PARTS_FIRST_SCENE on.
/// @param usual     how many
/// @param scene_of  seed -> a struct that says by describe() what it is
/// @param broken    which promise a scene breaks, empty if none; fills its tally
/// @param simpler   the same scene less this or that, or less of it
template <class MakeScene, class Broken, class Simpler>
SceneTally check_scenes(unsigned usual, const MakeScene& scene_of, const Broken& broken, const Simpler& simpler) {
  SceneTally tally;
  const unsigned first = number_from("PARTS_FIRST_SCENE", 0), count = number_from("PARTS_SCENES", usual);
  for (unsigned seed = first; seed < first + count; ++seed) {
    auto scene = scene_of(seed);
    ++tally.scenes;
    std::string what = broken(scene, tally);
    if (what.empty()) continue;
    SceneTally ignored;
    for (bool shrunk = true; shrunk;) {
      shrunk = false;
      for (const auto& next : simpler(scene)) {
        const std::string still = broken(next, ignored);
        if (still.empty()) continue;
        scene = next, what = still, shrunk = true;
        break;
      }
    }
    ADD_FAILURE() << "seed " << seed << ": " << what << "\n  shrunk to " << scene.describe();
  }
  testing::Test::RecordProperty("scenes", tally.scenes);
  testing::Test::RecordProperty("refused", tally.refused);
  testing::Test::RecordProperty("doubted", tally.doubted);
  testing::Test::RecordProperty("flawless", tally.flawless);
  return tally;
}

/// As a user is told it: what is worse in the result than in the inputs.
inline std::string worse_than(const std::vector<Mesh>& inputs, const Mesh& result,
                              const mesh::ResultRules& rules = {}) {
  const auto measured = [](const Mesh& m) { return mesh::measure_surface(mesh::in_single_precision(m)); };
  std::vector<mesh::SurfaceFigures> before;
  for (const Mesh& m : inputs) before.push_back(measured(m));
  return mesh::worse_than_inputs(measured(result), before, rules);
}

/// Another one of a class for another seed: an egg with a bump on its upper side.
inline Mesh bean(unsigned seed, int subdivisions) {
  Random random(seed);
  const double length = random.uniform(1, 1.15), height = random.uniform(0.2, 0.35);
  const double at_x = random.uniform(0.05, 0.15), at_y = random.uniform(0.05, 0.15);
  Mesh m = sphere(Vec3::Zero(), 1, subdivisions);
  for (Vec3& v : m.vertices) {
    const Vec3 p = v.cwiseProduct(Vec3(1, length, 0.9));
    const double off = std::pow(p.x() - at_x, 2) + std::pow(p.y() - at_y, 2);
    v = p * (1 + (p.z() > 0 ? height * std::exp(-12 * off) : 0));
  }
  return m;
}

/// Colours by place, and texture coordinates as seen from the front.
inline void dress(Mesh& mesh, bool colors, bool texture) {
  const Box box = mesh.bounds();
  const auto share = [&](const Vec3& p) { return (p - box.min()).cwiseQuotient(box.sizes()).eval(); };
  if (colors)
    for (const Vec3& p : mesh.vertices) {
      const Vec3 s = 255 * share(p);
      mesh.vertex_color.push_back({std::uint8_t(s[0]), std::uint8_t(s[1]), std::uint8_t(s[2]), 255});
    }
  if (!texture) return;
  mesh.textures = {"skin.png"};
  for (int f = 0; f < mesh.face_count(); ++f) {
    Wedges w;
    w.texture = 0;
    for (int k = 0; k < 3; ++k) w.uv[k] = share(mesh.corner(f, k)).head<2>().cast<float>();
    mesh.wedges.push_back(w);
  }
}

/// Of the faces that lie in both meshes, bit for bit, the first corner with another
/// colour or place in the texture; but for faces that are selected, which are new.
inline std::string dressed_otherwise(const Mesh& before, const Mesh& after) {
  constexpr float kSameTexel = 1e-6f;
  std::map<FaceKey, int> known;
  for (int f = 0; f < before.face_count(); ++f) known[face_key(before, f)] = f;
  std::ostringstream what;
  for (int f = 0; f < after.face_count() && what.str().empty(); ++f) {
    const auto was = known.find(face_key(after, f));
    if (was == known.end() || (!after.face_selected.empty() && after.face_selected[f])) continue;
    const int g = was->second;
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) {
        if (after.corner(f, k) != before.corner(g, j)) continue;
        if (!before.vertex_color.empty() &&
            after.vertex_color[after.faces[f][k]] != before.vertex_color[before.faces[g][j]])
          what << "face " << f << " has another colour; ";
        if (before.wedges.empty()) continue;
        const Wedges &now = after.wedges[f], &then = before.wedges[g];
        if (now.texture != then.texture || !((now.uv[k] - then.uv[j]).norm() < kSameTexel))
          what << "face " << f << " shows texture " << now.texture << " at " << now.uv[k].transpose() << " instead of "
               << then.texture << " at " << then.uv[j].transpose() << "; ";
      }
  }
  return what.str();
}

}  // namespace parts::test
