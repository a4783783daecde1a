// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/cut/seam_values.h"

namespace parts::cut {

/// Where one model ends: it is kept where the value is positive. Faces that the
/// border does not pass are the model's own, bit for bit.
struct MeshBorder {
  SplitMesh split;               ///< the model, split where the border passes
  std::vector<double> value;     ///< per vertex of the split mesh
  std::vector<char> keep_level;  ///< per face: whether it is kept where all its values are zero
  std::vector<char> same;        ///< per face: at the border, and on the other model too; empty: none
};

/// One model with the labels of its work mesh.
struct LabelledModel {
  const Mesh& mesh;                       ///< of the model
  int side;                               ///< 0 = A, 1 = B
  const std::vector<SplitPoint>& points;  ///< that the work mesh was split at, the curve's first
  const std::vector<char>& still;         ///< per vertex of the model: edges between two of these stay whole
  const CrossingCurve& curve;
  const WorkMesh& work;
  const std::vector<Territory>& label;  ///< per face of the work mesh
};

/// The border where the values vanish.
/// @param even  the faces that it passes get the work mesh's other points too, so that they can give way
MeshBorder smooth_border(const LabelledModel& model, const SeamValues& values, bool even);

/// The border as the labels are, along faces of the work mesh.
MeshBorder raw_border(const LabelledModel& model);

/// How many borders the labels give a model, beside its own.
int count_loops(const LabelledModel& model);

}  // namespace parts::cut
