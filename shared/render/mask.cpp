// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/mask.h"

#include <opencv2/imgproc.hpp>

namespace parts::render {

cv::Point2d centroid(const cv::Mat& mask) {
  const cv::Moments m = cv::moments(mask, true);
  if (m.m00 <= 0) return {mask.cols / 2., mask.rows / 2.};
  return {m.m10 / m.m00, m.m01 / m.m00};
}

}  // namespace parts::render
