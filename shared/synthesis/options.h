// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace parts::synthesis {

/// What a window is compared by. Several channels may look at one plane.
struct PatchChannel {
  int plane = 0;           ///< index into PatchImage::planes
  double weight = 1;       ///< >= 0; 1: a difference of one standard deviation of the class counts 1
  bool detail = false;     ///< compares the plane's Laplacian band rather than its Gaussian level
  bool normalize = false;  ///< each window to zero mean and unit variance, against light and contrast
};

constexpr int most_channels = 11;  ///< that windows are compared by

struct SynthesisOptions {
  std::vector<PatchChannel> channels;     ///< at most most_channels; those of planes to be found take part once there
                                          ///< is an estimate
  std::vector<int> synthesized;           ///< indices of the planes to be found
  std::vector<int> patch_sizes{5, 7, 9};  ///< windows' sides in pixels, odd, coarse to fine: one a pyramid level
  double position = 1;                    ///< weight of the position relative to the foreground's centroid (4.1.4)
  double silhouette = 1;                  ///< weight of where a window is foreground
  bool centered = true;                   ///< false: positions are the pixels' own, in images that are aligned
  double size = 0;                        ///< pixels that count 1 in positions; 0: root of the query's foreground
  int max_iterations = 10;                ///< a level
  double tolerance = 0.005;   ///< stops a level when an iteration gains less than this share of the objective
  int longest_coarsest = 64;  ///< pixels: a larger coarsest level is halved, with the first patch size; 0: never
  int carried = 0;            ///< finest levels without a search: the matches of the level above, carried on
  double pca_share = 0;       ///< of the principal components (5.2) that propose candidates; 0 = the first 14
  bool exact_search = false;  ///< compare every window with every other: slow, to judge the search by
  int threads = 0;            ///< 0 = all cores; the result does not depend on it
};

}  // namespace parts::synthesis
