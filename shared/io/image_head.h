// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "parts/base/files.h"

namespace parts::io {

/// What the head of an image file says, before anything is allocated.
struct ImageHead {
  double width = 0, height = 0;  ///< pixels; double, as files may lie
  int bytes = 4;                 ///< a pixel once it is decoded, roughly
  bool pfm = false;              ///< a portable float map
  int orientation = 1;           ///< how the camera was held, by EXIF's numbers (1 to 8); 1: upright, or not said
};

/// Of a PNG, JPEG, TIFF, PFM, PNM, BMP, WebP or EXR file; nothing for other
/// formats or a head that cannot be read.
std::optional<ImageHead> read_image_head(const InputFile& file);
std::optional<ImageHead> read_image_head(std::string_view bytes);

}  // namespace parts::io
