// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/camera.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "parts/base/error.h"

namespace parts::render {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> pieces(1);
  for (char c : text)
    if (c == at)
      pieces.emplace_back();
    else
      pieces.back() += c;
  return pieces;
}

std::optional<double> degrees(std::string text) {
  text.erase(0, text.find_first_not_of(" \t\r\n"));
  text.erase(text.find_last_not_of(" \t\r\n") + 1);
  if (!text.empty() && text[0] == '+') text.erase(0, 1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

}  // namespace

std::vector<View> parse_views(const std::string& text) {
  std::vector<View> views;
  for (const std::string& piece : split(text, ';')) {
    if (piece.find_first_not_of(" \t\r\n") == piece.npos) continue;
    const std::vector<std::string> angles = split(piece, ',');
    const std::optional<double> yaw = degrees(angles[0]), pitch = degrees(angles.size() > 1 ? angles[1] : "0");
    if (angles.size() > 2 || !yaw || !pitch)
      throw UserError("The view \"" + piece + "\" is not \"yaw,pitch\" in degrees; write views as \"0,0; 40,15\".");
    views.push_back({*yaw, *pitch});
  }
  if (views.empty()) throw UserError("There is no view; write views as \"0,0; 40,15\" (yaw,pitch in degrees).");
  return views;
}

double angle_between(const View& a, const View& b) {
  constexpr double degree = EIGEN_PI / 180;
  const auto direction = [](const View& v) {
    const double yaw = v.yaw * degree, pitch = v.pitch * degree;
    return Vec3(std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch));
  };
  const Vec3 u = direction(a), v = direction(b);
  return std::atan2(u.cross(v).norm(), u.dot(v)) / degree;
}

Eigen::Matrix3d view_rotation(const View& view, const Vec3& up, const Vec3& front) {
  const Vec3 u = up.normalized(), left = u.cross(front.normalized());
  if (!(up.norm() > 0) || !(front.norm() > 0) || !(left.norm() > 1e-6))
    throw UserError("The directions Up and Front must differ and not be zero; set both to the model's axes.");
  const Vec3 side = left.normalized(), ahead = side.cross(u);
  const double yaw = view.yaw * EIGEN_PI / 180, pitch = view.pitch * EIGEN_PI / 180;
  const Vec3 level = std::cos(yaw) * ahead + std::sin(yaw) * side;  // from the model to the viewer
  Eigen::Matrix3d rotation;
  rotation.row(0) = u.cross(level);
  rotation.row(1) = std::cos(pitch) * u - std::sin(pitch) * level;
  rotation.row(2) = std::cos(pitch) * level + std::sin(pitch) * u;
  return rotation;
}

namespace {

Camera framing(const Eigen::Matrix3d& rotation, int width, int height) {
  Camera camera;
  camera.rotation = rotation;
  camera.width = width;
  camera.height = height;
  camera.center = {width / 2., height / 2.};
  return camera;
}

double radius_of(const Box& box) { return box.isEmpty() ? 1 : std::max(box.diagonal().norm() / 2, 1e-300); }

Vec3 center_of(const Box& box) { return box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.center()); }

}  // namespace

Camera orthographic_camera(const Eigen::Matrix3d& rotation, const Box& box, int width, int height, double margin) {
  Camera camera = framing(rotation, width, height);
  const double radius = radius_of(box);
  const Vec3 center = center_of(box);
  double half_width = radius * 1e-3, half_height = radius * 1e-3;
  for (int c = 0; c < 8 && !box.isEmpty(); ++c) {
    const Vec3 q = rotation * (box.corner(Box::CornerType(c)) - center);
    half_width = std::max(half_width, std::abs(q.x()));
    half_height = std::max(half_height, std::abs(q.y()));
  }
  camera.scale = (1 - 2 * margin) / 2 * std::min(width / half_width, height / half_height);
  camera.eye = center + 2 * radius * rotation.row(2).transpose();
  return camera;
}

}  // namespace parts::render
