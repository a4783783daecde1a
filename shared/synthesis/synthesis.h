// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "parts/base/progress.h"

/// Planes are completed from examples, patch by patch: the optimisation behind
/// depth, back sides and colour (thesis 4.1, 5.1). It knows nothing of any of
/// these, only planes of numbers, some known and some to be found.
namespace parts::synthesis {

/// An example or the query. Planes are 32F, height x width, all of one size; a
/// query's synthesised planes may be empty. Values where the mask is 0 mean
/// nothing and are never read.
struct PatchImage {
  std::vector<cv::Mat> planes;
  cv::Mat mask;  ///< 8U, 0 = background
};

/// What a window is compared by. Several channels may look at one plane.
struct PatchChannel {
  int plane = 0;           ///< index into PatchImage::planes
  double weight = 1;       ///< >= 0; 1: a difference of one standard deviation of the class counts 1
  bool detail = false;     ///< compares the plane's Laplacian band rather than its Gaussian level
  bool normalize = false;  ///< each window to zero mean and unit variance, against light and contrast
};

struct SynthesisOptions {
  std::vector<PatchChannel> channels;     ///< those of planes to be found take part once there is an estimate
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

/// Where the optimisation stands, for those who change the examples meanwhile.
struct SynthesisState {
  int level = 0;  ///< 0 = finest
  int levels = 1;
  const std::vector<cv::Mat>& planes;  ///< all planes of the query at this level, found ones as estimated
  const cv::Mat& mask;                 ///< 8U, of this level
  const std::vector<long>& used;       ///< patches taken from each example
  const std::vector<char>& active;     ///< whether an example is searched
};

/// Examples to search from now on. A dropped one is searched no more; patches
/// that it gave stay until they are beaten, so the objective still never falls.
struct ExampleChange {
  std::vector<int> drop;        ///< indices
  std::vector<PatchImage> add;  ///< get the next indices
};

/// Called after the first iteration of each level (thesis 4.1.3).
using ExampleUpdate = std::function<ExampleChange(const SynthesisState&)>;

struct SynthesisResult {
  std::vector<cv::Mat> planes;  ///< the synthesised planes, 32F, in the order asked; 0 in the background
  cv::Mat example;              ///< 32S: the example that each pixel's patch came from; -1 = background
  cv::Mat source;               ///< 32SC2: the pixel (x, y) of that example at the patch's centre
  cv::Mat distance;             ///< 32F: root mean square difference of the patch, in standard deviations
  std::vector<std::vector<double>> objective;  ///< per level, coarse to fine, and iteration: mean log Sim (eq. 3)
  std::vector<long> used;                      ///< patches that each example gave in the end
  std::vector<char> active;                    ///< whether an example was still searched in the end
};

/// Makes estimated planes of a level agree where several pixels show one thing
/// (a linear projection, so that the objective still never falls).
/// @param level  0 = finest; pixel x of it lies at pixel x * 2^level of the finest
using Agreement = std::function<void(int level, std::vector<cv::Mat>& planes)>;

/// Finds the planes that make every window of the query like a window of the
/// examples: hard EM on the plausibility of eq. 3, coarse to fine.
/// @param query, examples  the same size in pixels is not needed, the same scale is
/// @throws UserError  no example, sizes that differ within an image, an empty
///                    mask, an even patch size or one larger than the image
SynthesisResult synthesize(const PatchImage& query, const std::vector<PatchImage>& examples,
                           const SynthesisOptions& options, const ExampleUpdate& update, Progress& progress,
                           const Agreement& agree = {});

}  // namespace parts::synthesis
