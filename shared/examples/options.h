// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/render/light.h"

namespace parts::examples {

/// How the models of a class become examples.
struct ExampleOptions {
  int width = 150, height = 200;     ///< pixels, 8 to 8192
  Vec3 up{0, 1, 0}, front{0, 0, 1};  ///< how the models stand
  render::Light light;
  bool back = true;      ///< the second depth layer too (thesis 4.2)
  double margin = 0.05;  ///< of the image's sides, free around the models
  int threads = 0;       ///< 0 = all cores
};

}  // namespace parts::examples
