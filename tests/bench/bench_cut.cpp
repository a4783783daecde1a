// SPDX-License-Identifier: GPL-3.0-or-later
// Cut times at the transition volumes of the thesis' Table 1, on scenes of our
// own with two overlapping models.

#include <algorithm>

#include "bench/measure.h"
#include "bench/scenes.h"
#include "parts/cut/decision.h"

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

/// The thesis' cut as compose() makes it, everything between voxels and labels.
/// @return its wall and processor time
Times cut_times(const Scene& scene, const Entry& entry, long& voxels) {
  // Grid::over adds a voxel all around.
  const int resolution = *std::max_element(entry.dims.begin(), entry.dims.end()) - 2;
  cut::Model a = cut::make_model(scene.a, "A"), b = cut::make_model(scene.b, "B");
  const Box volume = bounds(scene.a, scene.b);
  double wall = 1e300;
  const auto whole = best_of([&] {
    cut::CutReport report;
    Progress silent;
    const cut::Decision d = cut::decide(a, b, volume, resolution, 0, report, silent);
    if (report.grid != entry.dims || !d.labels.connected) throw std::logic_error("not the scene that was meant");
    wall = std::min(wall, report.cut_seconds), voxels = d.voxels.size();
  });
  const auto voxelization = best_of([&] { cut::joint_voxels(a, b, volume, resolution, 0); });
  return {wall, whole.cpu - voxelization.cpu};
}

}  // namespace

int main() {
  Table table("Minimal cut at the sizes of the thesis' Table 1, milliseconds: spheres / tubes / creatures",
              {"Example", "Grid", "Surface voxels", "Thesis' PC", "Processor", "Wall", "Processor < 50 ms"});
  for (const Entry& entry : kTable1) {
    std::vector<std::string> cells(2);
    std::string voxels_text;
    double worst = 0;
    for (Scene scene : {two_spheres(20000), two_tubes(20000), two_creatures(20000)}) {
      fit(scene, Vec3(entry.dims[0] - 2, entry.dims[1] - 2, entry.dims[2] - 2));
      long voxels = 0;
      const Times times = cut_times(scene, entry, voxels);
      worst = std::max(worst, times.cpu);
      const char* gap = cells[0].empty() ? "" : " / ";
      cells[0] += gap + text(times.cpu * 1e3), cells[1] += gap + text(times.wall * 1e3);
      voxels_text += gap + bench::count(double(voxels));
    }
    table.row({entry.name,
               bench::count(entry.dims[0]) + "×" + bench::count(entry.dims[1]) + "×" + bench::count(entry.dims[2]),
               voxels_text, text(entry.thesis_seconds * 1e3), cells[0], cells[1], verdict(worst < kTarget)});
  }
  table.note("The thesis' examples are not ours: only the sizes are the same. Best of several runs.");
}
