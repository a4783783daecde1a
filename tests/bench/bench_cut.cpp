// SPDX-License-Identifier: GPL-3.0-or-later
// Cut times at the transition volumes of the thesis' Table 1, on scenes of our
// own with two overlapping models.

#include <algorithm>

#include "bench/measure.h"
#include "bench/scenes.h"
#include "compose/decision.h"

using namespace parts;
using namespace parts::bench;

namespace {

struct Entry {
  const char* name;
  std::array<int, 3> dims;
  double thesis_seconds;  ///< Table 1, on a PC of its time
};
constexpr Entry kTable1[] = {{"Centaur", {34, 56, 26}, 1},
                             {"Dog-cow", {84, 61, 37}, 4},
                             {"Shades", {155, 71, 142}, 16},
                             {"Top hat", {104, 76, 92}, 40},
                             {"Cerberus", {29, 32, 29}, 0.3}};
constexpr double kTarget = 0.050;  // seconds

/// The cut as compose() makes it: everything between voxels and labels.
double cut_seconds(Scene& scene, const Entry& entry, Cut cut, long& voxels) {
  // Grid::over adds a voxel all around.
  const int resolution = *std::max_element(entry.dims.begin(), entry.dims.end()) - 2;
  Model a = make_model(scene.a, "A"), b = make_model(scene.b, "B");
  const Box volume = bounds(scene.a, scene.b);
  ComposeOptions options;
  options.cut = cut;
  double best = 1e300;
  best_of([&] {
    ComposeReport report;
    const Decision d = decide(a, b, volume, resolution, options, report);
    if (report.grid != entry.dims || !d.labels.connected) throw std::logic_error("not the scene that was meant");
    best = std::min(best, report.cut_seconds), voxels = d.voxels.size();
  });
  return best;
}

}  // namespace

int main() {
  Table table("Minimal cut at the sizes of the thesis' Table 1: milliseconds, spheres / tubes / creatures",
              {"Example", "Grid", "Surface voxels", "Thesis' PC", "Cut Thesis", "Cut Refined", "Each < 50 ms"});
  for (const Entry& entry : kTable1) {
    std::string thesis, refined, voxels_text;
    double worst = 0;
    for (Scene scene : {two_spheres(20000), two_tubes(20000), two_creatures(20000)}) {
      fit(scene, Vec3(entry.dims[0] - 2, entry.dims[1] - 2, entry.dims[2] - 2));
      long voxels = 0;
      const double t = cut_seconds(scene, entry, Cut::Thesis, voxels);
      const double r = cut_seconds(scene, entry, Cut::Refined, voxels);
      worst = std::max({worst, t, r});
      const char* gap = thesis.empty() ? "" : " / ";
      thesis += gap + text(t * 1e3), refined += gap + text(r * 1e3), voxels_text += gap + bench::count(double(voxels));
    }
    table.row(
        {entry.name,
         std::to_string(entry.dims[0]) + "×" + std::to_string(entry.dims[1]) + "×" + std::to_string(entry.dims[2]),
         voxels_text, text(entry.thesis_seconds * 1e3) + " ms", thesis, refined, verdict(worst < kTarget)});
  }
  table.note("The thesis' examples are not ours: only the sizes are the same. Best of several runs, wall time.");
}
