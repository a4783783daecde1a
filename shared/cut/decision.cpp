// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/decision.h"

#include <chrono>

#include "parts/base/parallel.h"

namespace parts::cut {

Decision decide(Model& a, Model& b, const Box& volume, int resolution, Cut cut, int threads, CutReport& report,
                Progress& progress) {
  Decision d;
  d.voxels = joint_voxels(a, b, volume, resolution, threads);
  progress.at(0.3);
  report.voxels_a = report.voxels_b = report.voxels_both = 0;
  for (int n = 0; n < int(d.voxels.size()); ++n) {
    const std::uint8_t flags = d.voxels.flags[n];
    if ((flags & kKeepA) && (flags & kKeepB)) throw SharedVoxel();
    report.voxels_a += (flags & kHasA) != 0, report.voxels_b += (flags & kHasB) != 0;
    report.voxels_both += d.voxels.both(n);
  }
  report.grid = d.voxels.grid.dims;
  report.voxel_size = d.voxels.grid.size;
  const auto start = std::chrono::steady_clock::now();
  if (cut == Cut::Thesis) {
    d.labels = thesis_cut(d.voxels);
  } else {
    std::vector<Eigen::Vector3f> normal_a, normal_b;
    parallel_for(2, threads, [&](long begin, long end) {
      for (long m = begin; m < end; ++m) (m ? normal_b : normal_a) = voxel_normals((m ? b : a).prepared.mesh, d.voxels);
    });
    // Where nearly coincident surfaces are some voxels apart, a cut that wants
    // them to meet runs wild: let it step over the gap, as far as it takes.
    constexpr int kFarthest = 3;
    double least = 2;
    for (int reach = 0; reach <= kFarthest && least > 0.1; ++reach) {
      progress.at(0.5 + 0.1 * reach);
      VoxelLabels labels = refined_cut(d.voxels, normal_a, normal_b, {reach});
      const double doubled = labels.connected ? double_layer(d.voxels, labels, normal_a, normal_b) : 1.5;
      if (doubled < least) least = doubled, d.reach = reach, d.labels = std::move(labels);
    }
  }
  report.cut_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.cut_cost = d.labels.cost;
  return d;
}

}  // namespace parts::cut
