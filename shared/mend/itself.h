// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/align/symmetry.h"
#include "parts/mend/fitting.h"
#include "parts/search/search.h"

namespace parts::mend {

/// A place of a scan that may show what a region of it lacks.
struct OwnPlace {
  PlacedModel model;  ///< of the scan, or of its mirror image, what is sound, moved there
  double score = 0;   ///< how far it is off around the region, of the region's half diagonal
};

/// A scan in place of a database: its mirror image in the planes in which it is
/// bilaterally symmetric, and other places of it that are alike (after Sharf,
/// Alexa, Cohen-Or, "Context-based surface completion", 2004, with the search
/// and the fit that other models have).
class Itself {
 public:
  /// @param scan     kept by reference
  /// @param regions  all that is to be mended: what is damaged shows nothing
  /// Logs the best plane: symmetry_residual, symmetry_normal, symmetry_point.
  /// @throws Cancelled
  Itself(const Scan& scan, const std::vector<Region>& regions, int threads, Progress& progress);

  /// The mirror images in the planes found, those first whose other half shows the whole region.
  std::vector<OwnPlace> mirror_images(const Region& region) const;

  /// The other places most like the one around a region, of the scan and of its
  /// mirror image; none if nothing is alike.
  /// @param now  the scan, perhaps mended elsewhere
  std::vector<OwnPlace> similar_places(const Scan& now, const Region& region, const search::SearchOptions& options,
                                       Progress& progress) const;

  /// Both, as many as the options ask for.
  std::vector<OwnPlace> places(const Scan& scan, const Region& region, const search::SearchOptions& options,
                               Progress& progress) const;

 private:
  Mesh sound_;  ///< without what is damaged
  std::vector<align::Symmetry> planes_;
};

}  // namespace parts::mend
