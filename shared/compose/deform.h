// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/compose/compose.h"

namespace parts::compose {

/// A similarity about a pivot: mirror, scale, rotate, then translate.
struct RigidPose {
  Vec3 pivot = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();  ///< of the rotation; normalised on use; the mirror plane's normal too
  double angle = 0;           ///< degrees
  Vec3 translation = Vec3::Zero();
  double scale = 1;     ///< uniform, > 0
  bool mirror = false;  ///< through the plane at the pivot with normal axis
};

/// Bends a model by rigid parts (thesis 3.3.3): a clone takes the pose, and the
/// two are composed, `fixed` kept on the model and `moving` on its clone.
/// @param frames  1 = the pose; N = N results from rest (an unchanged copy) to the pose
/// @return results without their clipped parts
/// @throws UserError, Cancelled  as compose()
std::vector<ComposeResult> deform(const Mesh& mesh, const std::vector<char>& fixed, const std::vector<char>& moving,
                                  const RigidPose& pose, int frames, const ComposeOptions& options, Progress& progress);

}  // namespace parts::compose
