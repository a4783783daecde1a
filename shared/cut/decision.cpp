// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/decision.h"

#include <chrono>

namespace parts::cut {

Decision decide(Model& a, Model& b, const Box& volume, int resolution, int threads, CutReport& report,
                Progress& progress) {
  Decision d;
  d.voxels = joint_voxels(a, b, volume, resolution, threads);
  progress.at(0.3);
  report.voxels_a = report.voxels_b = report.voxels_both = 0;
  for (int n = 0; n < int(d.voxels.size()); ++n) {
    const std::uint8_t flags = d.voxels.flags[n];
    if ((flags & kKeepA) && (flags & kKeepB)) {
      d.outcome = Decision::Outcome::SharedVoxel;
      return d;
    }
    report.voxels_a += (flags & kHasA) != 0, report.voxels_b += (flags & kHasB) != 0;
    report.voxels_both += d.voxels.both(n);
  }
  report.grid = d.voxels.grid.dims;
  report.voxel_size = d.voxels.grid.size;
  const auto start = std::chrono::steady_clock::now();
  d.labels = thesis_cut(d.voxels);
  if (!d.labels.connected) d.outcome = Decision::Outcome::Apart;
  report.cut_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.cut_cost = d.labels.cost;
  return d;
}

}  // namespace parts::cut
