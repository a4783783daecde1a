// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>

namespace parts::render {

/// The middle of a mask's foreground (8U, 0 = background), pixels; that of the
/// image where there is none.
cv::Point2d centroid(const cv::Mat& mask);

/// For each pixel, the pixel (x, y) of a mask's foreground that is nearest to it
/// (of the foreground: itself). Foreground must not be empty.
/// @return 32SC2
cv::Mat nearest_foreground(const cv::Mat& mask);

}  // namespace parts::render
