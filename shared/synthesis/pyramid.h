// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace parts::synthesis {

/// Fills the background from the foreground, smoothly (push-pull), so that no
/// filter sees an edge where there is none. plane 32F, mask 8U.
cv::Mat extend(const cv::Mat& plane, const cv::Mat& mask);

/// levels images, each half as large as the one before; the first is the image.
std::vector<cv::Mat> gaussian_pyramid(const cv::Mat& image, int levels);

/// An image twice as large, smooth; `size` is that of the level above.
cv::Mat expand(const cv::Mat& image, cv::Size size);

}  // namespace parts::synthesis
