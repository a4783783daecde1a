// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
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
  bool less_overlap = false;  ///< where less than that matches, look for places where 0.7, 0.5 or 0.3 do
  int threads = 0;            ///< 0 = all cores; the result does not depend on it
};

struct AlignResult {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();  ///< takes the moving model to the fixed one
  /// RMS distance from the fixed part to the share `overlap` of the moving part
  /// that is closest to it; at the initial placement and at the one found. World units.
  double rms_before = 0, rms_after = 0;
  /// Of the moving part, the share that lies on the fixed one: as near as noise
  /// lets expect (a hundredth of the part's RMS radius; up to three where the
  /// surfaces are as rough as that), normals within 45 degrees. Unlike
  /// rms_after it does not grow with a wrong place.
  double inlier_share = 0;
  double overlap = 0;  ///< that it was placed with
  int iterations = 0;  ///< of the final refinement
  int candidates = 0;  ///< coarse poses tried
  /// Sentences for the user, each with what to do: why the place may be wrong.
  std::vector<std::string> doubts;
};

/// Part-in-whole placement (thesis 3.2.1): PCA gives coarse poses, trimmed ICP
/// refines each, the one with the smallest residual wins; of equally good ones
/// that which moves the model least. Beyond the thesis: the poses come from
/// pieces of the parts as well, and from rotations spread evenly, so that a part
/// of a whole is found too; and the residual is measured from both sides.
/// Where too little of the part matches, or the sizes differ as if their units
/// did, the result says so: a place that fits nothing is found as well.
/// Distances are to the triangles: how finely a part is meshed and which way its
/// faces look does not matter.
/// @param moving_part, fixed_part  a flag a face; only flagged faces are
///        compared, all where none is. The matrix is for the whole model.
/// @throws UserError  a part without area, or with a coordinate that is not finite
/// @throws Cancelled
AlignResult align_part_in_whole(const Mesh& moving, const std::vector<char>& moving_part, const Mesh& fixed,
                                const std::vector<char>& fixed_part, const AlignOptions& options, Progress& progress);

}  // namespace parts::align
