// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "geometry/progress.h"
#include "mappings/example.h"

namespace parts {

struct ColorizeOptions {
  int examples = 2;                        ///< objects whose colours are used; 1 morphs one image-map onto the shape
  std::vector<std::string> choose;         ///< their labels; empty: those whose depth is most like the query's
  View view;                               ///< from which the depth was seen, of examples that have several
  std::vector<int> patch_sizes{9, 11, 7};  ///< windows' sides in pixels, odd, coarse to fine: one a pyramid level
  double weight_depth = 3;                 ///< weights: 1 = a difference of one standard deviation counts 1
  double weight_detail = 3;                ///< of the depth's high frequencies
  double weight_y = 1, weight_cb = 0.3, weight_cr = 0.3;
  double weight_position = 5;  ///< of the place relative to the foreground's centroid
  int max_iterations = 10;     ///< a level
  double pca_share = 0.2;      ///< of the principal components that propose candidates (5.2)
  bool harmonize = true;       ///< examples of another exposure or tint are matched to the best one
  unsigned seed = 0;           ///< 0: the most similar examples; others: drawn among the more similar half
  int threads = 0;             ///< 0 = all cores; the result does not depend on it
};

struct ColorizeResult {
  cv::Mat color;                               ///< 8UC3, BGR; black in the background
  cv::Mat mask;                                ///< 8U, 255 = foreground
  cv::Mat example;                             ///< 32S: index into `used` of each pixel's source; -1 = background
  cv::Mat source;                              ///< 32SC2: the pixel (x, y) of that example
  std::vector<std::string> used;               ///< labels of the examples, the most similar first
  std::vector<double> shares;                  ///< of the foreground that each of them gave
  std::vector<std::string> harmonized;         ///< labels of those whose colours were changed
  std::vector<std::vector<double>> objective;  ///< per level and iteration: mean log Sim (eq. 3)
  bool aligned = false;                        ///< the depth was moved and scaled into the examples' frame
  double patch_distance = 0;                   ///< root mean square difference of patches, in standard deviations
};

/// Synthesises an image-map for a depth map from those of similar objects
/// (thesis 5.1-5.3): depth and its high frequencies are known, Y, Cb and Cr are
/// found. Depths are compared by their shape: mean and range do not matter.
/// @param depth  32F, NaN = background, growing away from the camera, any unit
/// @throws UserError  a depth without foreground, a label that no example has, …
ColorizeResult colorize_depth(const cv::Mat& depth, ExampleSource& source, const ColorizeOptions& options,
                              Progress& progress);

}  // namespace parts
