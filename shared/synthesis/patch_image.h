// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace parts::synthesis {

/// An example or the query. Planes are 32F, height x width, all of one size; a
/// query's synthesised planes may be empty. Values where the mask is 0 mean
/// nothing and are never read.
struct PatchImage {
  std::vector<cv::Mat> planes;
  cv::Mat mask;  ///< 8U, 0 = background
};

}  // namespace parts::synthesis
