// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/rasterize.h"

#include "parts/base/parallel.h"

namespace parts::cut {

VoxelSet rasterize(const Mesh& mesh, const std::vector<char>& flags, const Grid& grid, int threads) {
  VoxelSet set(grid.count());
  parallel_for(mesh.face_count(), threads, [&](long begin, long end) {
    for (long f = begin; f < end; ++f)
      if (flags.empty() || flags[f]) for_each_voxel(grid, mesh, int(f), [&](std::size_t v) { set.add_shared(v); });
  });
  set.index();
  return set;
}

}  // namespace parts::cut
