// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/load_textures.h"

#include <opencv2/imgproc.hpp>

#include "parts/base/error.h"
#include "parts/io/raster_io.h"

namespace parts::render {

Textures load_textures(const Mesh& mesh) {
  Textures textures;
  for (const std::string& file : mesh.textures) {
    std::vector<cv::Mat> levels;
    cv::Mat image;
    try {
      image = io::read_texture(file);
    } catch (const UserError&) {  // as if there were none
    }
    while (!image.empty()) {
      levels.push_back(image);
      if (image.cols < 2 || image.rows < 2) break;
      cv::resize(image, image, cv::Size(image.cols / 2, image.rows / 2), 0, 0, cv::INTER_AREA);
    }
    textures.images.push_back(levels);
  }
  return textures;
}

}  // namespace parts::render
