// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

namespace parts::io {

/// What the head of an image file says, before anything is allocated.
struct ImageHead {
  double width = 0, height = 0;  ///< pixels; double, as files may lie
  int bytes = 4;                 ///< a pixel, roughly
};

/// Of a PNG, JPEG, TIFF, PFM, PNM or BMP file; nothing for other formats or a
/// head that cannot be read.
std::optional<ImageHead> read_image_head(const std::string& path);

}  // namespace parts::io
