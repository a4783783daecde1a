// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/synthesis/options.h"
#include "parts/synthesis/patch_image.h"
#include "parts/synthesis/search.h"

namespace parts::synthesis {

/// An image's planes and coverage at every level, fine to coarse.
struct ImagePyramid {
  std::vector<std::vector<cv::Mat>> planes;  ///< [plane][level], 32F, extended over the background
  std::vector<cv::Mat> coverage;             ///< [level], 32F, 0..1
  cv::Mat band(int plane, int level) const;  ///< the Laplacian band; the coarsest: the plane itself
};
ImagePyramid make_pyramid(const PatchImage& image, int levels);

/// What the channels of a level are scaled by, and the windows' layout.
struct LevelSetup {
  int level = 0;
  PatchLayout layout;
  std::vector<float> scale;  ///< a channel: root of the weight over the deviation; 1 if normalised
  bool searched = true;      ///< false: windows vote but are not compared
};
LevelSetup make_setup(const std::vector<ImagePyramid>& examples, const SynthesisOptions& options, int level, int side,
                      double size);

LevelExample make_level_example(const ImagePyramid& pyramid, const SynthesisOptions& options, const LevelSetup& setup);

/// The query at a level: known channels from its pyramid, synthesised ones from
/// the estimates (in the order of options.synthesized; empty: not yet).
PatchPlane make_level_query(const ImagePyramid& pyramid, const std::vector<cv::Mat>& estimate,
                            const SynthesisOptions& options, const LevelSetup& setup);

/// What the matched windows say of a synthesised plane, height x width, 32F:
/// Gaussian-weighted sums over all windows that cover a pixel.
struct Votes {
  cv::Mat weight, value, band;  ///< sums of g, g * value, g * band
};
std::vector<Votes> vote(const PatchPlane& query, const std::vector<Match>& matches,
                        const std::vector<LevelExample>& examples, const PatchLayout& layout, int planes, int threads);

}  // namespace parts::synthesis
