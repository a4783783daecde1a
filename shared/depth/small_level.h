// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/depth/options.h"
#include "parts/synthesis/synthesis.h"

namespace parts::depth {

/// The optimisation's options for {intensity, depth}.
synthesis::SynthesisOptions synthesis_options(const DepthOptions& options);

/// A first look: the optimisation of small images on one level, with windows of the first size.
/// @param options  of a whole reconstruction, as synthesis_options gives them
synthesis::SynthesisResult synthesize_small(const synthesis::PatchImage& query,
                                            const std::vector<synthesis::PatchImage>& examples,
                                            synthesis::SynthesisOptions options, int max_iterations);

/// How far a small query's patches are from the examples', in standard deviations: the mean of one iteration.
double small_distance(const synthesis::PatchImage& query, const std::vector<synthesis::PatchImage>& examples,
                      const synthesis::SynthesisOptions& options);

}  // namespace parts::depth
