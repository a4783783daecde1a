// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/examples/example.h"
#include "parts/examples/options.h"
#include "parts/render/load_textures.h"

namespace parts::examples {

/// A model with its images in memory, and where it is in the frame of its class.
struct ClassModel {
  std::string name;
  Mesh mesh;
  render::Textures textures;
  Vec3 center = Vec3::Zero();  ///< of its box: the image's centre
  double size = 1;             ///< world units that are drawn as large as those of other models
};

/// Half sizes of what a view of a model covers to the right and upwards of its
/// centre, world units.
Eigen::Vector2d extent(const Mesh& mesh, const Vec3& center, const Eigen::Matrix3d& rotation);

/// Sees a model from a view, orthographically, its centre in the image's centre.
/// @param frame  pixels that model.size covers
Example render_example(const ClassModel& model, const render::View& view, double frame, const ExampleOptions& options);

}  // namespace parts::examples
