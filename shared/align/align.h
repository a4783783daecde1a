// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"

namespace parts {

struct AlignOptions {
  bool coarse = true;        ///< start from every PCA pose; false: from where the models are
  bool allow_scale = false;  ///< uniform scale
  bool allow_mirror = false;
  int max_iterations = 100;  ///< ICP steps of the final refinement
  double overlap = 0.9;      ///< share of the part expected to match, (0, 1]
  int threads = 0;           ///< 0 = all cores; the result does not depend on it
};

struct AlignResult {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();  ///< takes the moving model to the fixed one
  double rms_before = 0, rms_after = 0;                  ///< of the inlier distances, world units
  double inlier_share = 0;                               ///< of the moving part's samples that match the fixed part
  int iterations = 0;
  int candidates = 0;  ///< coarse poses tried
};

/// Part-in-whole placement (thesis 3.2.1): PCA gives coarse poses, trimmed ICP
/// refines each, the one with the smallest residual wins. Only the emphasised
/// faces (flag 1; empty = all) are compared; the matrix is for the whole model.
/// @throws UserError  a part without area, or with a non-finite coordinate
AlignResult align_part_in_whole(const Mesh& moving, const std::vector<char>& moving_part, const Mesh& fixed,
                                const std::vector<char>& fixed_part, const AlignOptions& options, Progress& progress);

}  // namespace parts
