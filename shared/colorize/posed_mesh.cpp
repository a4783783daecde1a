// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/colorize/posed_mesh.h"

#include <algorithm>

#include "parts/base/error.h"
#include "parts/colorize/color_examples.h"

namespace parts::colorize {

examples::ClassModel pose(const Mesh& mesh, const examples::ClassModels& models, const ColorizeMeshOptions& options) {
  examples::ClassModel query;
  query.mesh = mesh;
  query.mesh.vertex_normal.clear();
  if (!options.keep.empty()) query.textures = render::load_textures(mesh);
  for (const Triangle& f : mesh.faces)
    for (int v : f)
      if (!mesh.vertices[v].allFinite())
        throw UserError("The mesh has coordinates that are not finite; remove those vertices first.");
  const Box box = mesh.bounds();
  if (!(box.diagonal().norm() > 0)) throw UserError("All of the mesh lies in one point; choose a surface.");
  const double size = models.shown_size(box.diagonal().norm());
  const examples::ExampleOptions& r = options.rendering;
  const Eigen::Matrix3d turn =
      render::view_rotation({}, r.up, r.front).transpose() * render::view_rotation({}, options.up, options.front);
  for (Vec3& v : query.mesh.vertices) v = turn * (v - box.center()) / size;
  return query;
}

double frame_for(const examples::ClassModel& query, const examples::ClassModels& models,
                 const ColorizeMeshOptions& options) {
  const examples::ExampleOptions& r = options.rendering;
  double frame = models.frame();
  for (const render::View& view : options.views) {
    const Eigen::Vector2d reach =
        examples::extent(query.mesh, query.center, render::view_rotation(view, r.up, r.front));
    frame = std::min(frame, 0.48 * std::min(r.width / std::max(reach.x(), 1e-9), r.height / std::max(reach.y(), 1e-9)));
  }
  return frame;
}

std::vector<examples::Example> see(const examples::ClassModel& model, double frame,
                                   const std::vector<render::View>& views, const examples::ExampleOptions& rendering) {
  std::vector<examples::Example> all;
  for (const render::View& view : views) all.push_back(examples::render_example(model, view, frame, rendering));
  return all;
}

std::vector<synthesis::PatchImage> planes_of(const std::vector<examples::Example>& views) {
  std::vector<synthesis::PatchImage> all;
  for (const examples::Example& view : views) all.push_back(color_planes(view));
  return all;
}

}  // namespace parts::colorize
