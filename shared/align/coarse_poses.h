// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/align/pose.h"
#include "parts/spatial/surface.h"

namespace parts::align {

/// A coarse pose and where it comes from.
struct CoarsePose {
  Pose pose;
  bool thesis = false;  ///< whole on whole by PCA, as in the thesis: never dropped unrefined
};

/// A surface as far as coarse poses look at it, in its own frame.
struct CoarseSurface {
  const std::vector<spatial::Sample>& samples;
  Eigen::Matrix3d covariance;
  double area;
};

/// Poses to start from. For the whole surfaces, and for the pieces of each that
/// may be the matching part (where the areas or the overlap say that not all of
/// it is): centroid on centroid, turned by the 24 rotations that take one set of
/// principal axes to the other, and by rotations spread evenly, for parts
/// whose axes PCA cannot tell or an overlap that bends them.
/// @param scale    of the moving frame in the fixed one
/// @param overlap  share of the moving surface that is expected to match
std::vector<CoarsePose> coarse_poses(const CoarseSurface& moving, const CoarseSurface& fixed, double scale,
                                     double overlap);

/// count rotations spread evenly over all of them (super-Fibonacci spirals, Alexa 2022).
std::vector<Eigen::Matrix3d> spread_rotations(int count);

/// The 24 rotations of a cube.
std::vector<Eigen::Matrix3d> axis_rotations();

}  // namespace parts::align
