// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/load_textures.h"

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace parts::render {

Textures load_textures(const Mesh& mesh) {
  Textures textures;
  for (const std::string& file : mesh.textures) {
    std::vector<cv::Mat> levels;
    cv::Mat image;
    std::error_code error;
    try {
      if (std::filesystem::is_regular_file(file, error)) image = cv::imread(file, cv::IMREAD_COLOR);
    } catch (const cv::Exception&) {  // larger than OpenCV reads
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
