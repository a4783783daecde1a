// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

namespace parts::cut {

/// Which cut decides where one model ends and the other begins.
enum class Cut {
  Refined,  ///< a minimal vertex cut through the voxels that both surfaces share, a smooth border in them
  Thesis,   ///< equations 1 and 2 exactly as printed, borders along voxel sides
};

/// What a cut through voxels measured.
struct CutReport {
  std::array<int, 3> grid{0, 0, 0};  ///< voxels along x, y, z
  double voxel_size = 0;             ///< world units
  long voxels_a = 0, voxels_b = 0, voxels_both = 0;
  double cut_cost = 0;  ///< in the cut's own unit
  double cut_seconds = 0;
};

}  // namespace parts::cut
