// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/labels.h"

namespace parts::cut {

/// Points on the curves in which the two meshes cross at a clear angle (over
/// 20°), within the seam voxels. There the best border is known exactly.
std::vector<Vec3> crossing_points(const Mesh& a, const Mesh& b, const JointVoxels& voxels, const VoxelLabels& labels);

}  // namespace parts::cut
