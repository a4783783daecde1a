// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/cut/mesh_labels.h"

namespace parts::cut {

/// Labels as values at the work meshes' vertices, smooth near the seam: both
/// borders, the values' zero sets, become smooth and face each other.
struct SeamValues {
  std::vector<double> value[2];  ///< per vertex of A's, of B's work mesh; positive in A's territory
  std::vector<char> pinned;      ///< per crossing segment: both borders run along it
  double edge = 0;               ///< world units: the mean edge at the seam
  double gap = 0;                ///< world units: the farthest that the labels' borders are apart
};

/// Minimises over both meshes the values' Dirichlet energy, a pull to the
/// labels (without it a small loop could vanish on one mesh only), and springs
/// from each vertex to the nearest agreeing point of the other mesh. Vertices
/// of forced faces keep their label; where the models cross on the seam at a
/// clear angle the values are zero.
/// @param longest  world units: edges count as no longer than this
SeamValues smooth_values(const Model& a, const Model& b, const MeshProblem& problem, const MeshLabels& labels,
                         const CrossingCurve& curve, double longest);

}  // namespace parts::cut
