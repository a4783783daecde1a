// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

namespace parts::render {

/// The one depth that stands for "nothing there" in a raster that does not say
/// so by 0, infinity or NaN, as renderers and sensors write 1e10, 65535 or their
/// far plane: the largest one, where it is that very number in many pixels, also
/// at the image's border, and lies a jump behind what is beside it. A raster of
/// plates that are all as flat has none: there, it may be a wall.
/// @param depth  32F, NaN = background
std::optional<float> find_background(const cv::Mat& depth);

/// Which depth is background, besides 0, infinity and NaN.
struct BackgroundRule {
  bool automatic = true;        ///< what find_background finds
  std::optional<double> value;  ///< else this one, in the raster file's unit
};
/// Reads "auto", "none" or a number. @throws UserError  anything else
BackgroundRule parse_background(const std::string& text);

/// What was made background, NaN.
struct RemovedBackground {
  double value = 0;  ///< in the raster file's unit
  long pixels = 0;   ///< 0: there was none
};
/// @param scale  world units of the depth that one unit of the file stands for
/// @param back   of the same view, or empty; it loses that value too
/// @throws UserError  nothing is left
RemovedBackground remove_background(const BackgroundRule& rule, double scale, cv::Mat& depth, cv::Mat& back);

}  // namespace parts::render
