// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "parts/mesh/mesh.h"
#include "parts/render/camera.h"

namespace parts::render {

/// A mesh's images as 8-bit BGR, each followed by its halves (a pyramid); an
/// image that is missing or unreadable is an empty pyramid.
struct Textures {
  std::vector<std::vector<cv::Mat>> images;
};

struct RenderOptions {
  bool smooth = true;              ///< normals of vertices (the mesh's own, or means); false: of faces
  bool colors = true;              ///< the mesh's texture, else vertex, else face colours; false: base
  Color base{200, 200, 204, 255};  ///< where the mesh has no colour
  Color background{255, 255, 255, 255};
  Vec3 light{0.3, 0.4, 0.85};    ///< direction to the light, camera frame, any length
  double ambient = 0.35;         ///< 0..1, share of light that comes from everywhere
  double sky = 0;                ///< 0..1, share of that which comes from above rather
  double rim = 0;                ///< 0..1, darkening towards silhouettes
  bool mark_back_faces = false;  ///< back faces reddish; else lit from both sides
  double edge_width = 0;         ///< pixels; > 0 draws the edges of faces
  int threads = 0;               ///< 0 = all cores; the result does not depend on it
};

/// What a camera sees, height x width each.
struct Rendering {
  cv::Mat image;       ///< 8UC3, BGR
  cv::Mat depth;       ///< 32F, of the nearest surface (see Camera); NaN = background
  cv::Mat back_depth;  ///< 32F, of the farthest surface at the pixel; NaN = background
  cv::Mat mask;        ///< 8U, 255 = surface
  cv::Mat face;        ///< 32S, index of the nearest face; -1 = background
};

/// Draws a mesh with a depth buffer at the pixels' centres, without gaps along
/// shared edges. A surface at the same depth as another is hidden by the lower
/// face index. Faces with a corner behind a pinhole camera or not finite are
/// left out.
Rendering render(const Mesh& mesh, const Textures& textures, const Camera& camera, const RenderOptions& options);

}  // namespace parts::render
