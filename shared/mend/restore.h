// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/base/progress.h"
#include "parts/cut/cut.h"
#include "parts/mend/region.h"
#include "parts/seam/seam.h"

namespace parts::mend {

/// What mends a scan: a model in the scan's place and size, as the search left it.
struct PlacedModel {
  Mesh mesh;
  std::string name;
};

struct RestoreOptions {
  double constraint_distance = 0.3;  ///< share of the region's half size (flaws) or of the largest distance of the
                                     ///< model from the scan (holes), 0 to 1
  bool refine = true;                ///< ICP on the surface around the region, before anything else
  bool allow_scale = true;           ///< the ICP may change the model's size
  bool fit_to_rim = true;            ///< bend the model onto the scan around the region; false: as it is (thesis)
  int tries = 5;                     ///< of so many models the first that closes what was opened is the base
  int blend = 16;                    ///< how many of the models are blended, at most; 1 = the base alone
  cut::Cut cut = cut::Cut::Mesh;  ///< Thesis: compose() with the constraints of Fig. 7
  int resolution = 0;                ///< of the thesis' cut
  seam::SeamSmoothing smoothing;     ///< distance 0 = two edges of the rim
  int threads = 0;                   ///< 0 = all cores; the result does not depend on it
};

/// What mending one region measured.
struct RestoreReport {
  int model = -1;                        ///< which of the models was used (the first of the blended)
  int blended = 1;                       ///< how many
  double rms_before = 0, rms_after = 0;  ///< distance between model and scan around the region, world units
  double inlier_share = 0;               ///< of the model's vertices around the region, those that match the scan
  int faces_replaced = 0;                ///< of the scan
  int faces_added = 0;                   ///< from the model and the stitch
  int rims_joined = 0, borders_capped = 0, islands_dropped = 0;
  double seam_length = 0, seam_gap = 0;  ///< world units
};

struct Restored {
  Mesh mesh;
  std::vector<char> face_from_model;  ///< per face: 0 the scan's, 1 the model's, 2 made by the stitch
  Mesh candidate;                     ///< the model as it was pasted: placed, fitted
  RestoreReport report;
};

/// Replaces a flawed surface by that of a model (thesis 3.3.1), or fills a hole
/// with it (3.3.2). The models, best first, are tried in their order until one
/// closes what was opened. Faces outside the region, and for holes all faces of the scan but
/// loose pieces within the hole, are copied bit for bit.
/// @param scan    prepared: welded, its faces oriented
/// @param region  of flaw_regions() or hole_regions() of this scan
/// @throws UserError  no model covers the region
/// @throws Cancelled
Restored restore_surface(const Mesh& scan, const Region& region, const std::vector<PlacedModel>& models,
                         const RestoreOptions& options, Progress& progress);
Restored fill_hole(const Mesh& scan, const Region& region, const std::vector<PlacedModel>& models,
                   const RestoreOptions& options, Progress& progress);

}  // namespace parts::mend
