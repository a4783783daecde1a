// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>

#include "parts/render/camera.h"

namespace parts::render {

/// The step in depth between neighbouring pixels from which on they are taken
/// for two surfaces: four times the step that three quarters of all neighbours
/// stay below, and at least six pixels' width (steeper than about 80 degrees).
/// What lies far behind, or how far, does not matter.
/// @param depth  32F, NaN = background
/// @return world units, at the median depth; 0 where there are no neighbours
double automatic_jump(const cv::Mat& depth, const Camera& camera);

}  // namespace parts::render
