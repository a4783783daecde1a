// SPDX-License-Identifier: GPL-3.0-or-later
// Whole compositions, end to end: two meshes of 20,000 faces at the default
// resolution, and how time grows up to two of 1,000,000.

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
      const char* name = cut == cut::Cut::Thesis ? "Thesis" : "Mesh";
      if (!c.ended) {
        table.row({scene.name, name, "failed"});
        continue;
      }
      table.row({scene.name, name, grid(c), text(c.figures[3]), text(c.figures[0]), text(c.figures[1]),
                 count(c.figures[8]) + ", " + count(c.figures[9]), verdict(c.figures[0] < 0.5)});
    }
}

void large_meshes() {
  Table table("Large meshes (Mesh)", {"Scene", "Faces each", "Wall s", "Processor s", "Peak memory", "Faces in",
                                      "Time to the row above", "Target"});
  struct Size {
    int faces;
    double seconds, bytes;
  };
  for (const auto& make : {two_spheres, two_creatures}) {
    double before = 0;
    for (const Size& size : {Size{125000, 0, 0}, Size{500000, 1.5, 0}, Size{1000000, 4, 1.2e9}}) {
      const Scene scene = make(size.faces);
      const Child c = composed(scene, 0, cut::Cut::Mesh, true);
      if (!c.ended) {
        table.row({scene.name, count(size.faces), "failed"});
        continue;
      }
      const bool good = c.figures[0] < size.seconds && (size.bytes == 0 || c.peak < size.bytes);
      table.row({scene.name, count(scene.a.mesh.face_count()), text(c.figures[0]), text(c.figures[1]),
                 megabytes(c.peak), count(scene.a.mesh.face_count() + scene.b.mesh.face_count()),
                 before > 0 ? ratio(c.figures[1] / before) : "", size.seconds > 0 ? verdict(good) : ""});
      before = c.figures[1];
    }
  }
  table.note("Peak memory is that of the whole process, both inputs in it. Ratios are of processor time.");
}

}  // namespace

int main() {
  small_meshes();
  large_meshes();
}
