// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "parts/base/progress.h"
#include "parts/depth/evidence.h"
#include "parts/depth/options.h"
#include "parts/depth/query.h"
#include "parts/examples/example.h"

namespace parts::depth {

/// An example that was in use, and what it gave.
struct UsedExample {
  std::string object;
  render::View view;
  long patches = 0;
};

struct DepthResult {
  cv::Mat depth;          ///< 32F, the query's size, the database's units from the camera; NaN = background
  cv::Mat back_depth;     ///< the same of the back; empty unless asked for
  cv::Mat mask;           ///< 8U, 255 = foreground
  render::Camera camera;  ///< in which the query shows what the depth says, in the database's frame; orthographic

  render::View view;                     ///< estimated: the mean of the angles in use, weighted by their patches
  std::optional<examples::Light> light;  ///< in which the examples were rendered; nothing where they are stored
  double scale = 1, rotation = 0;        ///< of the query to fit the examples; degrees anticlockwise
  std::vector<UsedExample> used;         ///< every example that was in use
  cv::Mat example;                       ///< 32S, the query's size: index into used; -1 = background
  cv::Mat distance;                      ///< 32F, the query's size: of each patch, in standard deviations
  std::vector<std::vector<double>> plausibility;  ///< a level, coarse to fine, and iteration: mean log of eq. 3
  Evidence evidence;                              ///< for and against the result
  bool trusted = true;                            ///< as is_trusted says
};

/// The depth of one image by example (thesis 4.1): every patch of image and
/// depth shall look like one of the examples.
/// @throws UserError  an image, mask or weight that cannot be used, or too
///                    little of the query is foreground
DepthResult reconstruct_depth(const DepthQuery& query, examples::ExampleSource& source, const DepthOptions& options,
                              Progress& progress);

}  // namespace parts::depth
