// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/examples/render_example.h"

#include <algorithm>
#include <cmath>

#include "parts/render/rasterize.h"

namespace parts::examples {

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
  look.threads = options.threads;
  render::Rendering seen = render::render(model.mesh, model.textures, camera, look);
  out.image = seen.image;
  out.depth = seen.depth;
  out.mask = seen.mask;
  if (options.back) out.back_depth = seen.back_depth;
  return out;
}

}  // namespace parts::examples
