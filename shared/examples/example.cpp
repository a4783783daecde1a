// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/examples/example.h"

namespace parts::examples {

double Example::pixels_per_unit() const {
  if (camera.focal <= 0) return camera.scale;
  const cv::Scalar mean = cv::mean(depth, mask);
  return mean[0] > 0 ? camera.focal / mean[0] : 1;
}

}  // namespace parts::examples
