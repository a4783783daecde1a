// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/render/rasterize.h"

namespace parts::render {

/// A projected vertex: pixels and depth; x is NaN where it cannot be seen.
struct ScreenPoint {
  double x, y, z;
};

/// Fills out.image from out.face: light and colour once a pixel.
void shade(const Mesh& mesh, const Textures& textures, const Camera& camera, const RenderOptions& options,
           const std::vector<ScreenPoint>& points, Rendering& out);

}  // namespace parts::render
