// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::render {

/// A mesh's images as 8-bit BGR, each followed by its halves (a pyramid); an
/// image that is missing or unreadable is an empty pyramid.
struct Textures {
  std::vector<std::vector<cv::Mat>> images;
};
Textures load_textures(const Mesh& mesh);

}  // namespace parts::render
