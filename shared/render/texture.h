// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "parts/io/raster_io.h"

namespace parts::render {

/// Whether the host can show an image file on a mesh as it is: a PNG, JPEG or
/// BMP of 8 bits a channel, held upright, with nothing transparent.
/// @param image  what read_image(path) gave
bool shows_as_texture(const std::string& path, const io::Image& image);

/// Where a texture is written and what it must not replace.
struct TextureTarget {
  std::string file;                 ///< an image file that may be replaced; empty: one is found beside `beside`
  std::string beside;               ///< the result's own file; "face.tif" gives face_texture.png
  std::vector<std::string> inputs;  ///< files that are never replaced
};

/// Adds an image as a texture to the files of a result, the colours of the foreground extended over the
/// rest, so that no background shows at silhouettes. Without target.file the name
/// is the first of x_texture.png, x_texture_2.png ... that is free or has that
/// very picture already; no other run can take it meanwhile.
/// @return the file, absolute
/// @throws UserError  target.file is an input, or it cannot be written
std::string add_texture(OutputFiles& files, const cv::Mat& color, const cv::Mat& mask, const TextureTarget& target);

/// The same as an image in memory.
cv::Mat extend_colors(const cv::Mat& color, const cv::Mat& mask);

}  // namespace parts::render
