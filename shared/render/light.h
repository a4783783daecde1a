// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/mesh.h"

namespace parts::render {

/// One light far away, and what comes from everywhere.
struct Light {
  Vec3 direction{0.3, 0.4, 0.85};  ///< towards it, camera frame (x right, y up, z to the viewer), any length
  double ambient = 0.35;           ///< 0..1, the share that comes from everywhere
};

}  // namespace parts::render
