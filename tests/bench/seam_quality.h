// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::bench {

/// How good the triangles are near a curve.
struct SeamQuality {
  int faces = 0;               ///< with a vertex within the distance
  double least_angle = 0;      ///< degrees, the smallest of all
  double median_angle = 0;     ///< degrees, of each face's smallest
  double slivers = 0;          ///< share of faces with an angle under 5°
  double edge_ratio = 0;       ///< mean over faces of longest to shortest edge
  double dihedral_rms = 0;     ///< degrees from flat, over the faces' edges, weighted by length
  double dihedral_spread = 0;  ///< degrees, how much that varies along the seam (standard deviation)
};

/// @param curve  points on it, no farther apart than `distance`
SeamQuality seam_quality(const Mesh& mesh, const std::vector<Vec3>& curve, double distance);

/// Whether every edge has two faces that run along it in opposite directions.
bool closed_and_oriented(const Mesh& mesh);

double volume(const Mesh& mesh);
double mean_edge(const Mesh& mesh);

/// Share of a result's vertices that lie exactly (as floats) on one of the inputs'.
double share_of_input_vertices(const Mesh& result, const Mesh& a, const Mesh& b);

}  // namespace parts::bench
