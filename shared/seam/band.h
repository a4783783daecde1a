// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::seam {

/// What lies along the surface within a distance of a seam.
struct Band {
  static constexpr double kBeyond = std::numeric_limits<double>::infinity();
  std::vector<int> vertices;             ///< the nearest first; the seam's own among them
  std::vector<double> away;              ///< per vertex: world units along edges from the seam, or kBeyond
  std::vector<std::vector<int>> around;  ///< per vertex of the band: its neighbours
  std::vector<char> on_border;           ///< per vertex of the band: on an edge that has not two faces
};

/// @param seam  per vertex: not 0 on the seam
Band band_around(const Mesh& mesh, const std::vector<char>& seam, double distance);

}  // namespace parts::seam
