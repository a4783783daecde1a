// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "parts/render/camera.h"

namespace parts {

/// Frames the box's sphere with a pinhole camera of that focal length (pixels).
inline render::Camera pinhole_camera(const Eigen::Matrix3d& rotation, const Box& box, int width, int height,
                                     double focal, double margin = 0.05) {
  render::Camera camera = render::orthographic_camera(rotation, box, width, height);
  camera.scale = 1;
  camera.focal = focal;
  const double half = (1 - 2 * margin) / 2 * std::min(width, height);
  // The sphere's silhouette is a tangent cone: sin of its half angle = radius / distance.
  const double distance = box.diagonal().norm() / 2 * std::hypot(focal, half) / half;
  camera.eye = box.center() + distance * rotation.row(2).transpose();
  return camera;
}

}  // namespace parts
