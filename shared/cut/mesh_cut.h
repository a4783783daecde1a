// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "parts/base/progress.h"
#include "parts/cut/cut.h"
#include "parts/cut/mesh_borders.h"

namespace parts::cut {

/// A minimal cut on the two meshes themselves (thesis 6.1).
struct MeshCut {
  MeshBorder border[2];  ///< smooth; of A, of B
  /// As the labels are, along faces of the work meshes: 0 = A's, 1 = B's. Valid
  /// as long as the models live.
  std::function<MeshBorder(int side)> raw_border;
  int loops[2] = {0, 0};  ///< that the labels' borders have
  double edge = 0;        ///< world units: the mean edge at the seam
  double step = 0;        ///< world units: what is nearer is one place
  double gap = 0;         ///< world units: the farthest that the borders are apart
};

/// Every face of both meshes gets one label, the territory that it lies in, by
/// a minimal cut in a graph of both: a face of A is kept in A's, one of B in
/// B's. Where it changes costs the gap to the other surface and a price per
/// length; faces that could replace each other, and the sides of the curve in
/// which the meshes cross, are tied together. Of several minimal cuts, for
/// growing gaps, the one with the best seam is taken, and found again finer.
/// @param even  see smooth_border
/// @pre both models look outward, or both inward
/// @throws UserError  the models do not meet between their marks
MeshCut cut_meshes(const Model& a, const Model& b, const Box& volume, bool even, int threads, CutReport& report,
                   Progress& progress);

}  // namespace parts::cut
