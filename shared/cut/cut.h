// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

namespace parts::cut {

/// Which cut decides where one model ends and the other begins.
enum class Cut {
  Mesh,    ///< on a graph of the two meshes' faces (thesis 6.1), smooth borders
  Thesis,  ///< equations 1 and 2 exactly as printed, borders along voxel sides
};

/// What a cut measured.
struct CutReport {
  std::array<int, 3> grid{0, 0, 0};  ///< Thesis: voxels along x, y, z
  double voxel_size = 0;             ///< Thesis: world units
  long voxels_a = 0, voxels_b = 0, voxels_both = 0;
  double scale = 0;            ///< Mesh: RMS size of the smaller model, world units
  double reach = 0;            ///< Mesh: how far apart the models could be at the seam, world units
  long crossing_segments = 0;  ///< Mesh: of the curve in which the models cross
  long broken_ties = 0;        ///< Mesh: of those where only one model could be cut
  double seam_edge = 0;        ///< world units: what the seam's edges are measured by, of Thesis a voxel
  double cut_cost = 0;         ///< in the cut's own unit
  double cut_seconds = 0;
};

}  // namespace parts::cut
