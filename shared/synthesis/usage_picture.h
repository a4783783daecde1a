// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>

namespace parts::synthesis {

/// Where pixels came from (thesis Fig. 27c): a colour an example, each as
/// different from the ones before as can be.
/// @param example     32S, as SynthesisResult::example; -1 = background
/// @param background  BGR
/// @return 8UC3
cv::Mat usage_picture(const cv::Mat& example, const cv::Scalar& background = {});

}  // namespace parts::synthesis
