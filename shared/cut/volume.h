// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/cut/joint.h"
#include "parts/cut/labels.h"
#include "parts/mesh/prepare.h"

namespace parts::cut {

/// A model and the faces of it that must survive (one flag a face).
struct Part {
  Mesh mesh;
  std::vector<char> keep;
  std::string name = {};  ///< in error sentences; empty: "model A", "model B"
};

/// A model ready to be cut: its prepared mesh and its flags.
struct Model {
  std::string name;  ///< in sentences: "model A"
  mesh::Prepared prepared;
  std::vector<char> keep;  ///< per face: must survive
  std::vector<int> piece;  ///< per face: number of its outer piece in JointVoxels, -1 inside the volume
};

/// Prepares a part. @throws UserError  no face, or no constraint
Model make_model(const Part& part, const std::string& name);

/// The box in which the models may be joined: the user's, or both models'.
/// @throws UserError  it has no thickness, is not finite, or misses a model
Box transition_volume(const Model& a, const Model& b, const Box& asked);

/// Voxels along the longest side from the meshes' mean edge.
int natural_resolution(const Model& a, const Model& b, const Box& volume);

/// Rasterises both models. Sets Model::piece.
/// @throws UserError  a constraint outside the volume, both constraints in one
///                    voxel, or not enough memory (asked before it is taken)
JointVoxels joint_voxels(Model& a, Model& b, const Box& volume, int resolution, int threads);

/// Per node: the sum of the unit normals of a model's faces that touch the voxel.
std::vector<Eigen::Vector3f> voxel_normals(const Mesh& mesh, const JointVoxels& voxels);

/// How much of the result lies in two layers: of the smaller model's kept
/// voxels, the share (0..1) away from the seam that a nearly parallel kept
/// surface of the other model passes within three voxels. Large where the cut
/// joined two nested copies instead of crossing from one to the other.
double double_layer(const JointVoxels& voxels, const VoxelLabels& labels, const std::vector<Eigen::Vector3f>& normal_a,
                    const std::vector<Eigen::Vector3f>& normal_b);

}  // namespace parts::cut
