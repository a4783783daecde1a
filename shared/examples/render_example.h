// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/examples/example.h"
#include "parts/render/rasterize.h"

namespace parts::examples {

/// How the models of a class become examples.
struct ExampleOptions {
  int width = 150, height = 200;     ///< pixels, 8 to 8192
  Vec3 up{0, 1, 0}, front{0, 0, 1};  ///< how the models stand
  Vec3 light{0.3, 0.4, 0.85};        ///< direction to the light, camera frame (x right, y up, z to the viewer)
  double ambient = 0.35;             ///< 0..1
  bool back = true;                  ///< the second depth layer too (thesis 4.2)
  double margin = 0.05;              ///< of the image's sides, free around the models
  int threads = 0;                   ///< 0 = all cores
};

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
