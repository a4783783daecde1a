// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/base/progress.h"
#include "parts/depth/gallery.h"
#include "parts/depth/options.h"
#include "parts/depth/query.h"

namespace parts::depth {

/// The foreground of an image whose border is background of one colour, give or
/// take little; nothing where the border has many colours.
cv::Mat plain_background_mask(const cv::Mat& color);

/// Finds the object of the class in an image (thesis 6.2): a first guess from a
/// plain border or by laying examples over the image, then segmentation and depth synthesised together from
/// the examples, each of which knows its foreground, then the cut that colours
/// and synthesised segmentation agree on (Rother et al. 2004, "GrabCut").
/// @param query  its mask, where not empty, holds the object
/// @return 8U, 255 = foreground
/// @throws UserError  nothing like an object was found
cv::Mat segment(const DepthQuery& query, Gallery& gallery, const DepthOptions& options, Progress& progress);

}  // namespace parts::depth
