// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/base/progress.h"
#include "parts/cut/cut.h"
#include "parts/cut/labels.h"
#include "parts/cut/volume.h"

namespace parts::cut {

/// The joint voxels and their labels.
struct Decision {
  enum class Outcome {
    Cut,         ///< the models meet and are parted
    Apart,       ///< they do not meet between their constraints: the grid may be too fine
    SharedVoxel  ///< constraints of both pass through one voxel: the grid is too coarse
  };
  Outcome outcome = Outcome::Cut;
  JointVoxels voxels;
  VoxelLabels labels;
};

/// Finds the thesis' cut at one resolution. Fills the report's figures on voxels and cut.
/// @throws UserError  too little memory, a constraint outside the volume
Decision decide(Model& a, Model& b, const Box& volume, int resolution, int threads, CutReport& report,
                Progress& progress);

}  // namespace parts::cut
