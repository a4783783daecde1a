// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/examples/render_example.h"

#include <algorithm>
#include <cmath>

namespace parts::examples {

double Example::pixels_per_unit() const {
  if (camera.focal <= 0) return camera.scale;
  const cv::Scalar mean = cv::mean(depth, mask);
  return mean[0] > 0 ? camera.focal / mean[0] : 1;
}

double angle_between(const render::View& a, const render::View& b) {
  constexpr double degree = EIGEN_PI / 180;
  const auto direction = [](const render::View& v) {
    const double yaw = v.yaw * degree, pitch = v.pitch * degree;
    return Vec3(std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch));
  };
  const Vec3 u = direction(a), v = direction(b);
  return std::atan2(u.cross(v).norm(), u.dot(v)) / degree;
}

Eigen::Vector2d extent(const Mesh& mesh, const Vec3& center, const Eigen::Matrix3d& rotation) {
  Eigen::Vector2d most(0, 0);
  for (const Triangle& f : mesh.faces)
    for (int v : f) most = most.cwiseMax((rotation.topRows<2>() * (mesh.vertices[v] - center)).cwiseAbs());
  return most;
}

Example render_example(const ClassModel& model, const render::View& view, double frame, const ExampleOptions& options) {
  Example out;
  out.object = model.name;
  out.view = view;
  render::Camera& camera = out.camera;
  camera.rotation = render::view_rotation(view, options.up, options.front);
  camera.width = options.width;
  camera.height = options.height;
  camera.center = {options.width / 2., options.height / 2.};
  camera.scale = frame / model.size;
  camera.eye = model.center + model.size * camera.rotation.row(2).transpose();  // in front of all of it

  render::RenderOptions look;
  look.light = options.light;
  look.ambient = options.ambient;
  look.threads = options.threads;
  render::Rendering seen = render::render(model.mesh, model.textures, camera, look);
  out.image = seen.image;
  out.depth = seen.depth;
  out.mask = seen.mask;
  if (options.back) out.back_depth = seen.back_depth;
  return out;
}

}  // namespace parts::examples
