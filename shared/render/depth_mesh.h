// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>

#include "parts/base/progress.h"
#include "parts/mesh/mesh.h"
#include "parts/render/camera.h"

namespace parts::render {

struct DepthMeshOptions {
  /// Depth between neighbouring pixels at which the surface is torn, world
  /// units. 0 = automatic_jump.
  double max_jump = 0;
};

struct DepthMesh {
  Mesh mesh;              ///< oriented towards the camera, with normals and, per face, texture coordinates
  double max_jump = 0;    ///< that was used
  long torn = 0;          ///< pixels that were torn from a neighbour
  int dropped_faces = 0;  ///< of the fringes between torn surfaces
  int walls = 0;          ///< faces between front and back
  long back_before = 0;   ///< pixels whose back depth was missing or before the front
};

/// The surface of a depth raster: a vertex at the centre of each pixel, faces
/// between neighbours, torn where depth jumps. Strips between two tears that are
/// at most two pixels wide are dropped: they are no surface but pixels between
/// two of them. Texture coordinates show an image of the same view (the image
/// itself is the caller's: textures is empty, and wedges name texture 0).
///
/// With a back depth, one closed solid: at each pixel what is between front and
/// back. It is torn where there is more than max_jump of nothing between the
/// solids of two neighbours, in front and back alike; the rims are closed by walls
/// of triangles about as large as the others; the back is at least half a pixel's
/// width behind the front. Manifold without boundary.
/// @param depth   32F, NaN = background; the size of the camera's image
/// @param back    the same of the farthest surface, or empty
/// @throws UserError  no two neighbouring pixels have a depth, a pinhole camera's
///                    depth is not positive, sizes differ, the memory is too small
DepthMesh depth_to_mesh(const cv::Mat& depth, const cv::Mat& back, const Camera& camera,
                        const DepthMeshOptions& options, Progress& progress);

/// The camera of a raster of which only the pixels are known: at the origin,
/// looking along -z, y up.
/// @param pixel_size  world units, orthographic
/// @param focal       pixels; 0 = orthographic
Camera raster_camera(cv::Size size, double pixel_size, double focal);

}  // namespace parts::render
