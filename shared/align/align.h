// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/base/progress.h"
#include "parts/mesh/mesh.h"

namespace parts::align {

struct AlignOptions {
  bool coarse = true;         ///< look for the placement from any start; false: refine where the models are
  bool allow_scale = false;   ///< uniform scale
  bool allow_mirror = false;  ///< with coarse: a reflection, where it fits clearly better than any rotation
  int max_iterations = 100;   ///< ICP steps of the final refinement; it mostly stops after 5 to 20
  double overlap = 0.9;       ///< share of the moving part expected to match, (0, 1]
  int threads = 0;            ///< 0 = all cores; the result does not depend on it
};

struct AlignResult {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();  ///< takes the moving model to the fixed one
  /// RMS distance from the fixed part to the share `overlap` of the moving part
  /// that is closest to it; at the initial placement and at the one found. World units.
  double rms_before = 0, rms_after = 0;
  /// Of the moving part, the share that lies closer to the fixed one than three
  /// times rms_after or a thousandth of the part's size, whichever is more.
  double inlier_share = 0;
  int iterations = 0;  ///< of the final refinement
  int candidates = 0;  ///< coarse poses tried
};

/// Part-in-whole placement (thesis 3.2.1): PCA gives coarse poses, trimmed ICP
/// refines each, the one with the smallest residual wins; of equally good ones
/// that which moves the model least. Beyond the thesis: the poses come from
/// pieces of the parts as well, and from rotations spread evenly, so that a part
/// of a whole is found too; and the residual is measured from both sides.
/// Distances are to the triangles: how finely a part is meshed and which way its
/// faces look does not matter.
/// @param moving_part, fixed_part  a flag a face; only flagged faces are
///        compared, all where none is. The matrix is for the whole model.
/// @throws UserError  a part without area, or with a coordinate that is not finite
/// @throws Cancelled
AlignResult align_part_in_whole(const Mesh& moving, const std::vector<char>& moving_part, const Mesh& fixed,
                                const std::vector<char>& fixed_part, const AlignOptions& options, Progress& progress);

}  // namespace parts::align
