// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "parts/io/raster_io.h"
#include "parts/mesh/mesh.h"

namespace parts::render {

/// An image of the same view as a depth raster.
struct ViewImage {
  io::Image image;
  /// The file says how the camera was held. Rasters of depth cannot say that:
  /// the image is taken as it is stored, like them, where its proportions are
  /// then the depth's, and else turned as it says.
  enum class Held { NotSaid, AsStored, Turned } held = Held::NotSaid;
  double off = 0;  ///< its proportions beside the depth's: a share of 1; width and rows by one scale, about the middle
};

/// Proportions may differ by a pixel, or by a hundredth: the sensors of a depth
/// camera cut the same view differently.
/// @throws UserError  as read_image; other proportions
ViewImage read_view_image(const std::string& path, cv::Size depth);

/// Fits texture coordinates that spread an image over a depth raster to its
/// proportions.
void fit_texture(Mesh& mesh, cv::Size depth, cv::Size image);

}  // namespace parts::render
