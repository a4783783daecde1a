// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::render {

/// From where a model is seen, in degrees. Yaw turns the viewer around the up
/// axis, counter-clockwise from above (90 = the model's left side); pitch lifts
/// the viewer (90 = from above).
struct View {
  double yaw = 0, pitch = 0;
};

/// Reads "yaw,pitch; yaw,pitch; …"; a missing pitch is 0.
/// @throws UserError  anything else, or no view at all
std::vector<View> parse_views(const std::string& text);

/// The angle between two directions of view, degrees.
double angle_between(const View& a, const View& b);

/// A camera of width x height pixels. Its frame: x right, y up, z towards the
/// viewer. Pixels: x right, y down, the first one's centre at (0.5, 0.5).
/// Depth: world units from the eye along the viewing direction, growing away.
struct Camera {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< world to camera frame
  Vec3 eye = Vec3::Zero();                                 ///< where depth is 0
  int width = 0, height = 0;                               ///< pixels
  double focal = 0;                                        ///< pixels; 0 = orthographic
  double scale = 1;                                        ///< pixels a world unit; orthographic only
  Eigen::Vector2d center = Eigen::Vector2d::Zero();        ///< pixel that the eye looks at

  /// (x, y, depth) of a world point.
  Vec3 project(const Vec3& p) const {
    const Vec3 q = rotation * (p - eye);
    const double s = focal > 0 ? focal / -q.z() : scale;
    return {center.x() + s * q.x(), center.y() - s * q.y(), -q.z()};
  }
  /// The world point seen at a pixel in a depth.
  Vec3 unproject(double x, double y, double depth) const {
    const double s = focal > 0 ? depth / focal : 1 / scale;
    return eye + rotation.transpose() * Vec3((x - center.x()) * s, (center.y() - y) * s, -depth);
  }
};

/// The rotation of a view of a model that stands along `up` and faces `front`.
/// @throws UserError  up or front is zero, or they are parallel
Eigen::Matrix3d view_rotation(const View& view, const Vec3& up, const Vec3& front);

/// Frames a box in an orthographic image, with `margin` (share of the image's
/// sides) left free; the eye is two radii from its centre.
Camera orthographic_camera(const Eigen::Matrix3d& rotation, const Box& box, int width, int height,
                           double margin = 0.05);

}  // namespace parts::render
