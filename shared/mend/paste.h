// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mend/scan.h"
#include "parts/seam/seam.h"

namespace parts::mend {

struct PasteOptions {
  double size = 0;       ///< of the region, world units
  double tolerance = 0;  ///< how far a model's surface may lie from the scan's and still be the same, world units
  bool replace_islands = true;  ///< loose pieces that the patch runs along give way to it
  seam::SeamSmoothing smoothing;
  int threads = 0;
};

struct Pasted {
  bool reached = false;  ///< the model has surface that continues the scan at the rim
  bool closed = false;   ///< the hole is gone and nothing new is open or non-manifold
  Mesh mesh;
  std::vector<int> source;                  ///< per face: its number in the scan, or a NewFace
  int joined = 0, capped = 0, islands = 0;  ///< rims joined, borders closed, loose pieces in the hole dropped
  long crossings = 0;                       ///< pairs of faces at the seam that cross
  double seam_length = 0, seam_gap = 0;     ///< world units
};

/// Puts the part of a model that continues a scan into its hole. The scan stays
/// as it is, to its rim; the model is clipped along the rim (where its nearest
/// point on the scan is on the border), stitched to it, and smoothed beside it.
/// Rims of other holes that the same part of the model reaches are joined too.
/// @param scan  prepared: welded, its faces oriented
/// @param model fitted to the scan, welded, faces oriented as the scan's
/// @param rim   the hole: of find_rims()
Pasted paste(const Mesh& scan, const Mesh& model, const mesh::Loop& rim, const PasteOptions& options);

}  // namespace parts::mend
