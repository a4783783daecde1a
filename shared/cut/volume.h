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
  std::string name = {};        ///< in error sentences; empty: "model A", "model B"
  std::vector<char> drop = {};  ///< faces that must go; empty: none
};

/// A model ready to be cut: its prepared mesh and its flags.
struct Model {
  std::string name;  ///< in sentences: "model A"
  mesh::Prepared prepared;
  std::vector<char> keep;  ///< per face: must survive
  std::vector<char> drop;  ///< per face: must go; empty: none
  std::vector<int> piece;  ///< per face: number of its outer piece in JointVoxels, -1 inside the volume
};

/// Prepares a part. @throws UserError  no face, or no constraint
Model make_model(const Part& part, const std::string& name);

/// The box in which the models may be joined: the user's, or both models'.
/// @throws UserError  it has no thickness, is not finite, or misses a model
Box transition_volume(const Model& a, const Model& b, const Box& asked);

/// Whether a face has a point in common with a box that is no thinner than a hair.
bool touches(const Mesh& mesh, int face, const Box& box);

/// @throws UserError  a model, or what is to be kept of it, has no face in the volume
void check_volume(const Model& model, const Box& volume);

/// Voxels along the longest side from the meshes' mean edge.
int natural_resolution(const Model& a, const Model& b, const Box& volume);

/// Whether the free memory holds a grid of so many voxels along the longest side.
bool fits_memory(const Model& a, const Model& b, const Box& volume, int resolution);

/// Rasterises both models. Sets Model::piece.
/// @throws UserError  a constraint outside the volume, both constraints in one
///                    voxel, or not enough memory (asked before it is taken)
JointVoxels joint_voxels(Model& a, Model& b, const Box& volume, int resolution, int threads);

}  // namespace parts::cut
