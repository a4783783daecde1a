// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/labels.h"

namespace parts::cut {

/// The transition surface as a mesh to look at (thesis 3.2.3): all voxel sides
/// between voxels labelled A and B, turned toward A. Empty voxels take the label
/// of the nearest that has one. Grids of more than 128 voxels a side are drawn
/// coarser.
/// @param smoothing  rounds of Laplacian smoothing; 0 shows the sides as they are
Mesh transition_surface(const JointVoxels& voxels, const VoxelLabels& labels, int smoothing);

}  // namespace parts::cut
