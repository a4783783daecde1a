// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "parts/align/icp.h"
#include "parts/spatial/closest_point.h"

namespace parts::align {

/// How finely poses are compared.
struct Detail {
  int samples = 1000;
  bool exact = true;         ///< distances to the triangles, not to the grid's samples
  bool other_sizes = false;  ///< score: half of it is how well the pose would fit with another scale
};

/// Two surfaces, ready to be compared in any pose of the moving one.
class Comparison {
 public:
  /// @param moving, fixed  are kept by reference
  Comparison(const spatial::Surface& moving, const spatial::Surface& fixed, double overlap);

  /// Makes the grids that comparisons which are not exact need.
  void prepare_grids();

  /// The residual of a pose, in the moving surface's unit (RMS radii): both of
  /// the moving surface's distance from the fixed one and of the reverse, the
  /// latter as far as the moving surface's area goes. Of poses that lay the part
  /// equally well on something, the one that something fits to as well is right.
  double score(const Pose& pose, const Detail& detail) const;

  /// Trimmed ICP from start; the score is the one above.
  IcpResult refine(const Pose& start, const Detail& detail, const IcpOptions& options,
                   const std::function<void()>& poll) const;

  /// Distances from the fixed surface, sorted, in its unit; one a sample of the moving one.
  std::vector<double> distances(const Pose& pose, int threads) const;

  /// The share of the moving samples that lie within a distance (in the fixed
  /// surface's unit) of the fixed surface, their normals within 45 degrees of its.
  double share_within(double distance, const Pose& pose, int threads) const;

  const std::vector<spatial::Sample>& moving_samples(bool mirrored) const { return moving_samples_[mirrored]; }
  const std::vector<spatial::Sample>& fixed_samples() const { return fixed_samples_[0]; }

  static constexpr int kSamples = 3000;  ///< at most, of each surface

 private:
  const spatial::ClosestPoint& moving_target(bool exact) const;
  const spatial::ClosestPoint& fixed_target(bool exact) const;

  const spatial::Surface &moving_, &fixed_;
  double overlap_;
  spatial::TriangleTree moving_tree_, fixed_tree_;
  std::unique_ptr<spatial::ClosestSampleGrid> moving_grid_, fixed_grid_;
  std::vector<spatial::Sample> moving_samples_[2], fixed_samples_[2];  ///< as they are, mirrored
};

}  // namespace parts::align
