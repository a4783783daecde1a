// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>

namespace parts::render {

/// The middle of a mask's foreground (8U, 0 = background), pixels; that of the
/// image where there is none.
cv::Point2d centroid(const cv::Mat& mask);

}  // namespace parts::render
