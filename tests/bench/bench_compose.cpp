// SPDX-License-Identifier: GPL-3.0-or-later
// Whole compositions, end to end: two meshes of 20,000 faces at the default
// resolution, two of 500,000 at 256, and how time grows with the resolution.

#include "bench/measure.h"
#include "bench/scenes.h"

using namespace parts;
using namespace parts::bench;

namespace {

/// Seconds (wall, processor), voxels, milliseconds of the cut, faces out.
std::vector<double> run(const Scene& scene, int resolution, cut::Cut cut, bool once) {
  compose::ComposeOptions options;
  options.resolution = resolution;
  options.cut = cut;
  Progress silent;
  compose::ComposeReport report;
  int faces = 0;
  const Times t = best_of(
      [&] {
        const compose::ComposeResult r = compose::compose(scene.a, scene.b, options, silent);
        report = r.report, faces = r.composed.face_count();
      },
      once ? 1 : 20);
  return {t.wall,
          t.cpu,
          double(report.voxels_a + report.voxels_b - report.voxels_both),
          report.cut_seconds * 1e3,
          double(faces),
          double(report.grid[0]),
          double(report.grid[1]),
          double(report.grid[2]),
          double(report.loops_joined),
          double(report.loops_open)};
}

Child composed(const Scene& scene, int resolution, cut::Cut cut, bool once) {
  return in_child([&] { return run(scene, resolution, cut, once); }, 300);
}

std::string grid(const Child& c) { return count(c.figures[5]) + "×" + count(c.figures[6]) + "×" + count(c.figures[7]); }

void small_meshes() {
  Table table("Two meshes of 20,000 faces at the default resolution",
              {"Scene", "Cut", "Grid", "Cut ms", "Wall s", "Processor s", "Loops joined, open", "< 0.5 s"});
  for (const Scene& scene : {two_spheres(20000), two_tubes(20000), two_tori(20000), two_creatures(20000)})
    for (const cut::Cut cut : {cut::Cut::Mesh, cut::Cut::Thesis}) {
      const Child c = composed(scene, 0, cut, false);
      const char* name = cut == cut::Cut::Thesis ? "Thesis" : "Refined";
      if (!c.ended) {
        table.row({scene.name, name, "failed"});
        continue;
      }
      table.row({scene.name, name, grid(c), text(c.figures[3]), text(c.figures[0]), text(c.figures[1]),
                 count(c.figures[8]) + ", " + count(c.figures[9]), verdict(c.figures[0] < 0.5)});
    }
}

void large_meshes() {
  constexpr double kMost = 1.5e9;
  Table table("Two meshes of 500,000 faces (Refined)",
              {"Scene", "Resolution", "Surface voxels", "Wall s", "Processor s", "Peak memory", "Time to the row above",
               "Voxels to the row above", "256: < 8 s, < 1.5 GB"});
  for (const Scene& scene : {two_spheres(500000), two_creatures(500000)}) {
    double before = 0, voxels_before = 0;
    for (const int resolution : {128, 256, 512}) {
      const Child c = composed(scene, resolution, cut::Cut::Mesh, true);
      if (!c.ended) {
        table.row({scene.name, std::to_string(resolution), "failed"});
        continue;
      }
      const bool good = c.figures[0] < 8 && c.peak < kMost;
      table.row({scene.name, std::to_string(resolution), count(c.figures[2]), text(c.figures[0]), text(c.figures[1]),
                 megabytes(c.peak), before > 0 ? ratio(c.figures[1] / before) : "",
                 before > 0 ? ratio(c.figures[2] / voxels_before) : "", resolution == 256 ? verdict(good) : ""});
      before = c.figures[1], voxels_before = c.figures[2];
    }
  }
  table.note("Peak memory is that of the whole process, both inputs in it. Ratios are of processor time.");
}

}  // namespace

int main() {
  small_meshes();
  large_meshes();
}
