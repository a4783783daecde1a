// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "parts/base/progress.h"
#include "parts/synthesis/options.h"
#include "parts/synthesis/patch_image.h"

/// Planes are completed from examples, patch by patch: the optimisation behind
/// depth, back sides and colour (thesis 4.1, 5.1). It knows nothing of any of
/// these, only planes of numbers, some known and some to be found.
namespace parts::synthesis {

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
/// @throws std::invalid_argument  no channel or more than most_channels, or one of a plane that the images do not have
SynthesisResult synthesize(const PatchImage& query, const std::vector<PatchImage>& examples,
                           const SynthesisOptions& options, const ExampleUpdate& update, Progress& progress,
                           const Agreement& agree = {});

}  // namespace parts::synthesis
