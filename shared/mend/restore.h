// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/base/error.h"
#include "parts/base/progress.h"
#include "parts/cut/cut.h"
#include "parts/mend/acceptance.h"
#include "parts/mend/fitting.h"
#include "parts/mend/region.h"
#include "parts/seam/seam.h"

namespace parts::mend {

struct RestoreOptions {
  double constraint_distance = 0.3;  ///< share of the region's half size (flaws) or of the largest distance of the
                                     ///< model from the scan (holes), 0 to 1
  FittingOptions fitting;
  int tries = 5;                  ///< of so many models the first that is accepted is the base
  cut::Cut cut = cut::Cut::Mesh;  ///< Thesis: compose() with the constraints of Fig. 7
  int resolution = 0;             ///< of the thesis' cut
  seam::SeamSmoothing smoothing;  ///< distance 0 = two edges of the rim
  bool match_color = true;        ///< the patch's vertex colours go on from the scan's
  /// Where no database vouches for a model: by how much it may miss the sound
  /// surface beside the patch, of what a smooth surface does (foresight.h); 0 = not asked.
  double must_foretell = 0;
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
  std::vector<int> source;  ///< per face: its number in the scan, or a NewFace
  Mesh candidate;           ///< the model as it was pasted: placed, fitted
  RestoreReport report;
};

/// No model mends a region: which objection the best of them met.
class NotMended : public UserError {
 public:
  NotMended(const std::string& sentence, Objection why) : UserError(sentence), objection(why) {}
  Objection objection;
};

/// Replaces a flawed surface by that of a model (thesis 3.3.1), or fills a hole
/// with it (3.3.2). The models, best first, are tried in their order until one
/// is accepted: it closes what was to be closed, manifold, near the model, and
/// crosses nothing. Faces outside the region, and for holes all faces of the
/// scan but loose pieces within the hole, are copied bit for bit.
/// @param region  of flaw_regions() or hole_regions(), its rims those of this scan
/// @throws NotMended  no model is accepted; @throws UserError  an option is wrong
/// @throws Cancelled
Restored mend_region(const Scan& scan, const Region& region, const std::vector<PlacedModel>& models,
                     const RestoreOptions& options, Progress& progress);

}  // namespace parts::mend
