// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace parts::io {

/// A portable float map: text "Pf" (grey) or "PF" (colour), width, height and
/// scale, then floats row by row from the lowest. Only the scale's sign counts,
/// for the byte order: writers do not agree on what its size means.
/// @return 32FC1 or 32FC3 (BGR), first row on top; empty if the bytes are no whole PFM
cv::Mat parse_pfm(std::string_view bytes);

/// @param image  32FC1
std::string format_pfm(const cv::Mat& image);

}  // namespace parts::io
