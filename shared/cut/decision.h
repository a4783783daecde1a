// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/base/error.h"
#include "parts/base/progress.h"
#include "parts/cut/cut.h"
#include "parts/cut/labels.h"
#include "parts/cut/volume.h"

namespace parts::cut {

/// Constraints of both models pass through one voxel: the grid is too coarse.
struct SharedVoxel : UserError {
  SharedVoxel()
      : UserError(
            "What is to be kept of the two models lies in the same voxel; mark parts farther apart, or raise the "
            "Resolution.") {}
};

/// The joint voxels, their labels, and how far apart the models may be.
struct Decision {
  JointVoxels voxels;
  VoxelLabels labels;
  int reach = 0;
};

/// Finds the cut at one resolution. Labels that are not `connected` mean that
/// the models do not meet between their constraints. Fills the report's
/// figures on voxels and cut. @throws SharedVoxel, UserError
Decision decide(Model& a, Model& b, const Box& volume, int resolution, Cut cut, int threads, CutReport& report,
                Progress& progress);

}  // namespace parts::cut
