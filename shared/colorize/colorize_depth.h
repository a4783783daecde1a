// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/base/progress.h"
#include "parts/colorize/options.h"
#include "parts/colorize/report.h"
#include "parts/examples/example.h"

namespace parts::colorize {

struct ColorizeResult : ColorizeReport {
  cv::Mat color;    ///< 8UC3, BGR; black in the background
  cv::Mat mask;     ///< 8U, 255 = foreground
  cv::Mat example;  ///< 32S: index into `used` of each pixel's source; -1 = background
  cv::Mat source;   ///< 32SC2: the pixel (x, y) of that example
};

/// Synthesises an image-map for a depth map from those of similar objects
/// (thesis 5.1-5.3): depth and its high frequencies are known, Y, Cb and Cr are
/// found. Depths are compared by their shape: mean and range do not matter.
/// @param depth  32F, NaN = background, growing away from the camera, any unit
/// @throws UserError  a depth without foreground, a label that no example has, …
ColorizeResult colorize_depth(const cv::Mat& depth, examples::ExampleSource& source, const ColorizeOptions& options,
                              Progress& progress);

}  // namespace parts::colorize
