// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/joint.h"
#include "parts/cut/labels.h"

namespace parts::cut {

/// The transition surface as the zero set of a field over the voxels: positive
/// where A is kept, negative where B is. Both models are clipped by its sign,
/// so that their borders lie on one surface and face each other.
class Transition {
 public:
  /// The labels as they are: borders run along voxel sides (thesis 3.2.4).
  static Transition along_voxels(const JointVoxels& voxels, const VoxelLabels& labels);

  /// A smooth surface through the seam voxels: the field is harmonic in a band
  /// around them, pulled to the labels away from them and to zero at the points
  /// `crossings` where the two meshes truly cross.
  static Transition smooth(const JointVoxels& voxels, const VoxelLabels& labels, const std::vector<Vec3>& crossings);

  /// The field at a point of a model's surface, within the grid.
  double value(const Vec3& p, bool of_a) const;
  /// Whether the zero set may cut a model's surface in this voxel or beside it.
  bool near(std::size_t voxel, bool of_a) const { return near_[of_a].has(voxel); }

 private:
  Transition(const JointVoxels& voxels, const VoxelLabels& labels) : voxels_(&voxels), labels_(&labels) {}
  void solve(const std::vector<Vec3>& crossings);
  void mark_near();
  double at(int i, int j, int k, bool of_a, bool& known) const;

  const JointVoxels* voxels_;
  const VoxelLabels* labels_;
  VoxelSet band_;              ///< voxels with a smoothed value
  std::vector<double> value_;  ///< per band voxel
  VoxelSet near_[2];           ///< for B's surface, for A's
};

}  // namespace parts::cut
