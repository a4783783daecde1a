// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/depth/small_level.h"

namespace parts::depth {

synthesis::SynthesisOptions synthesis_options(const DepthOptions& options) {
  synthesis::SynthesisOptions o;
  o.channels = {
      {0, options.intensity, false, true}, {0, options.high_frequency, true, true}, {1, options.depth, false, false}};
  o.synthesized = {1};
  o.patch_sizes = options.patch_sizes;
  o.position = options.position;
  o.silhouette = options.silhouette;
  o.max_iterations = options.max_iterations;
  o.threads = options.threads;
  return o;
}

synthesis::SynthesisResult synthesize_small(const synthesis::PatchImage& query,
                                            const std::vector<synthesis::PatchImage>& examples,
                                            synthesis::SynthesisOptions options, int max_iterations) {
  options.patch_sizes = {options.patch_sizes.front()};
  options.longest_coarsest = 0;
  options.max_iterations = max_iterations;
  Progress quiet;
  return synthesis::synthesize(query, examples, options, {}, quiet);
}

double small_distance(const synthesis::PatchImage& query, const std::vector<synthesis::PatchImage>& examples,
                      const synthesis::SynthesisOptions& options) {
  return cv::mean(synthesize_small(query, examples, options, 1).distance, query.mask)[0];
}

}  // namespace parts::depth
