// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/synthesis/usage_picture.h"

#include <algorithm>
#include <cmath>

namespace parts::synthesis {

cv::Mat usage_picture(const cv::Mat& example, const cv::Scalar& background) {
  cv::Mat picture(example.size(), CV_8UC3, background);
  for (int y = 0; y < example.rows; ++y)
    for (int x = 0; x < example.cols; ++x) {
      const int k = example.at<int>(y, x);
      if (k < 0) continue;
      const double hue = std::fmod(k * 0.61803398875, 1.0) * 6, light = 1 - 0.18 * (k / 4 % 3);
      const auto wave = [&](double shift) {
        return uchar(255 * light * std::clamp(std::abs(std::fmod(hue + shift, 6.0) - 3) - 1, 0.1, 1.0));
      };
      picture.at<cv::Vec3b>(y, x) = {wave(2), wave(4), wave(0)};
    }
  return picture;
}

}  // namespace parts::synthesis
