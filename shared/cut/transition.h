// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/joint.h"
#include "parts/cut/labels.h"

namespace parts::cut {

/// The transition surface of voxel labels as the zero set of a field: positive
/// where A is kept, negative where B is. Both models are clipped by its sign,
/// along the sides of voxels (thesis 3.2.4).
class Transition {
 public:
  /// @param voxels, labels  kept by reference
  Transition(const JointVoxels& voxels, const VoxelLabels& labels);

  /// The field at a point of a model's surface, within the grid.
  double value(const Vec3& p, bool of_a) const;
  /// Whether the zero set may cut a model's surface in this voxel or beside it.
  bool near(std::size_t voxel, bool of_a) const { return near_[of_a].has(voxel); }

 private:
  /// The label of a voxel, 0 where the model is not in it.
  int at(int i, int j, int k, bool of_a) const;

  const JointVoxels& voxels_;
  const VoxelLabels& labels_;
  VoxelSet near_[2];  ///< for B's surface, for A's
};

}  // namespace parts::cut
