// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/synthesis/pyramid.h"

#include <opencv2/imgproc.hpp>

namespace parts::synthesis {
namespace {

// Premultiplied by weight: pulls down until one pixel is left, pushes up again.
void push_pull(cv::Mat& value, cv::Mat& weight) {
  if (value.rows <= 1 && value.cols <= 1) return;
  cv::Mat coarse, coarse_weight;
  cv::pyrDown(value, coarse);
  cv::pyrDown(weight, coarse_weight);
  // Full weight where any is: what is known shall not fade with the distance.
  for (int y = 0; y < coarse.rows; ++y)
    for (int x = 0; x < coarse.cols; ++x) {
      float& w = coarse_weight.at<float>(y, x);
      if (w <= 1e-6f) {
        w = 0, coarse.at<float>(y, x) = 0;
        continue;
      }
      const float full = std::min(1.f, 4 * w);
      coarse.at<float>(y, x) *= full / w;
      w = full;
    }
  push_pull(coarse, coarse_weight);
  cv::Mat up, up_weight;
  cv::pyrUp(coarse, up, value.size());
  cv::pyrUp(coarse_weight, up_weight, value.size());
  for (int y = 0; y < value.rows; ++y)
    for (int x = 0; x < value.cols; ++x) {
      float& w = weight.at<float>(y, x);
      if (w >= 1 || up_weight.at<float>(y, x) <= 0) continue;
      value.at<float>(y, x) += (1 - w) * up.at<float>(y, x) / up_weight.at<float>(y, x);
      w = 1;
    }
}

}  // namespace

cv::Mat extend(const cv::Mat& plane, const cv::Mat& mask) {
  cv::Mat value(plane.size(), CV_32F), weight(plane.size(), CV_32F);
  for (int y = 0; y < plane.rows; ++y)
    for (int x = 0; x < plane.cols; ++x) {
      const bool in = mask.at<uchar>(y, x) != 0;
      weight.at<float>(y, x) = in;
      value.at<float>(y, x) = in ? plane.at<float>(y, x) : 0;
    }
  push_pull(value, weight);
  return value;
}

std::vector<cv::Mat> gaussian_pyramid(const cv::Mat& image, int levels) {
  std::vector<cv::Mat> result{image};
  for (int l = 1; l < levels; ++l) {
    cv::Mat half;
    cv::pyrDown(result.back(), half);
    result.push_back(half);
  }
  return result;
}

cv::Mat expand(const cv::Mat& image, cv::Size size) {
  cv::Mat result;
  cv::pyrUp(image, result, size);
  return result;
}

}  // namespace parts::synthesis
