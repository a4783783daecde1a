// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "parts/mesh/mesh.h"

namespace parts::align {

/// Where the moving surface stands in the fixed one's frame: x -> scale * rotation * x + translation.
/// A mirrored pose takes the moving surface reflected in x first.
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double scale = 1;
  Vec3 translation = Vec3::Zero();
  bool mirrored = false;

  Vec3 operator()(const Vec3& p) const { return scale * (rotation * p) + translation; }
};

/// The angle between two rotations, radians.
inline double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return std::acos(std::clamp(((a.transpose() * b).trace() - 1) / 2, -1.0, 1.0));
}

}  // namespace parts::align
