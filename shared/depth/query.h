// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>

namespace parts::depth {

/// One image of an object of the class.
struct DepthQuery {
  cv::Mat color;  ///< 8UC3, BGR
  cv::Mat mask;   ///< 8U, 0 = background; empty: what a border of one colour leaves, or what segment finds
};

}  // namespace parts::depth
