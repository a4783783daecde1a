// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mincut/labels.h"

namespace parts {

/// The transition surface as a mesh to look at (thesis 3.2.3), A's side outside.
Mesh transition_surface(const JointVoxels& voxels, const VoxelLabels& labels);

}  // namespace parts
