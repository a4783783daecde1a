// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "align/pose.h"
#include "align/surface.h"

namespace parts {

/// A coarse pose and where it comes from.
struct CoarsePose {
  Pose pose;
  bool thesis = false;  ///< whole on whole by PCA, as in the thesis: never dropped unrefined
};

/// Poses to start from. For the whole surfaces, and for the pieces of each that
/// may be the matching part (where the areas or the overlap say that not all of
/// it is): centroid on centroid, turned by the 24 rotations that take one set of
/// principal axes to the other, and by rotations spread evenly, for parts
/// whose axes PCA cannot tell or an overlap that bends them.
/// @param samples  of each surface, in its own frame; of the moving one mirrored where `mirrored`
/// @param scale    of the moving frame in the fixed one
std::vector<CoarsePose> coarse_poses(const std::vector<Sample>& moving, const Eigen::Matrix3d& moving_covariance,
                                     const std::vector<Sample>& fixed, const Eigen::Matrix3d& fixed_covariance,
                                     double area_ratio, double scale, double overlap, bool mirrored);

/// count rotations spread evenly over all of them (super-Fibonacci spirals, Alexa 2022).
std::vector<Eigen::Matrix3d> spread_rotations(int count);

/// The 24 rotations of a cube.
std::vector<Eigen::Matrix3d> axis_rotations();

}  // namespace parts
