// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/depth_jump.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace parts::render {
namespace {

constexpr double kMost = 0.75;  // of the steps: less than surfaces that meet at jumps leave
constexpr double kTimes = 4;    // a sphere's rim, and nearly all noise, stay below
constexpr double kPixels = 6;

float quantile(std::vector<float>& values, double share) {
  const auto at = values.begin() + long(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

double automatic_jump(const cv::Mat& depth, const Camera& camera) {
  const auto pixel_width = [&](double z) { return camera.focal > 0 ? z / camera.focal : 1 / camera.scale; };
  std::vector<float> depths, slopes;  // slopes: steps in pixels' widths
  const auto add = [&](float a, float b) {
    if (!std::isnan(a) && !std::isnan(b)) slopes.push_back(float(std::abs(a - b) / pixel_width(std::min(a, b))));
  };
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth.at<float>(y, x);
      if (std::isnan(z)) continue;
      depths.push_back(z);
      if (x + 1 < depth.cols) add(z, depth.at<float>(y, x + 1));
      if (y + 1 < depth.rows) add(z, depth.at<float>(y + 1, x));
    }
  if (slopes.empty()) return 0;
  return std::max(kPixels, kTimes * quantile(slopes, kMost)) * pixel_width(quantile(depths, 0.5));
}

}  // namespace parts::render
