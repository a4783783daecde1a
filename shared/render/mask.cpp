// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/mask.h"

#include <opencv2/imgproc.hpp>
#include <vector>

namespace parts::render {

cv::Point2d centroid(const cv::Mat& mask) {
  const cv::Moments m = cv::moments(mask, true);
  if (m.m00 <= 0) return {mask.cols / 2., mask.rows / 2.};
  return {m.m10 / m.m00, m.m01 / m.m00};
}

cv::Mat nearest_foreground(const cv::Mat& mask) {
  cv::Mat distance, label, nearest(mask.size(), CV_32SC2);
  cv::distanceTransform(mask == 0, distance, label, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Vec2i> pixel(mask.total() + 1);  // of each label
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask.at<uchar>(y, x)) pixel[std::size_t(label.at<int>(y, x))] = {x, y};
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) nearest.at<cv::Vec2i>(y, x) = pixel[std::size_t(label.at<int>(y, x))];
  return nearest;
}

}  // namespace parts::render
