// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/render/camera.h"

namespace parts::colorize {

struct ColorizeOptions {
  int examples = 2;                        ///< objects whose colours are used; 1 morphs one image-map onto the shape
  std::vector<std::string> choose;         ///< their labels; empty: those whose depth is most like the query's
  render::View view;                       ///< from which the depth was seen, of examples that have several
  std::vector<int> patch_sizes{9, 11, 7};  ///< windows' sides in pixels, odd, coarse to fine: one a pyramid level
  double weight_depth = 3;                 ///< weights: 1 = a difference of one standard deviation counts 1
  double weight_detail = 3;                ///< of the depth's high frequencies
  double weight_y = 1, weight_cb = 0.3, weight_cr = 0.3;
  double weight_position = 5;  ///< of the place relative to the foreground's centroid
  int max_iterations = 10;     ///< a level
  double pca_share = 0.2;      ///< of the principal components that propose candidates (5.2)
  bool centered = true;        ///< images are compared centroid on centroid; false: as they lie, aligned already
  bool harmonize = true;       ///< examples of another exposure or tint are matched to the best one
  unsigned seed = 0;           ///< 0: the most similar examples; others: drawn among the more similar half
  int threads = 0;             ///< 0 = all cores; the result does not depend on it
};

}  // namespace parts::colorize
