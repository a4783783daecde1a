// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "parts/base/progress.h"
#include "parts/examples/example.h"

namespace parts::depth {

/// One image of an object of the class.
struct DepthQuery {
  cv::Mat color;  ///< 8UC3, BGR
  cv::Mat mask;   ///< 8U, 0 = background; empty: what a border of one colour leaves, or what segment finds
};

struct DepthOptions {
  int examples = 12;                      ///< at a time (thesis 4.1.3)
  std::vector<int> patch_sizes{5, 7, 9};  ///< pixels, odd, coarse to fine: one a pyramid level
  double intensity = 1;                   ///< weights, >= 0: how much each component of a patch counts (4.3.1)
  double high_frequency = 0.5;
  double depth = 0.2;
  double position = 5;                      ///< relative to the foreground's centroid (4.1.4); 0: anywhere
  double silhouette = 2;                    ///< where a patch is foreground; also seen from the start of the search
  std::vector<render::View> views{{0, 0}};  ///< from where the object may be seen; where the search for the view starts
  bool update_objects = true;               ///< better examples replace those that are used least
  bool update_views = true;                 ///< the view is searched for too, up to 40 degrees around the views given
  bool update_light = true;                 ///< the light is searched for too, where examples are rendered
  bool align = true;                        ///< the query is turned and scaled in the image plane to fit the examples
  bool segment = false;                     ///< the foreground is found as well, within the mask (6.2)
  bool back = false;                        ///< the back side too, from the front (4.2)
  int max_iterations = 10;                  ///< a level
  int objects = 64;                         ///< of the database that take part
  unsigned seed = 0;                        ///< chooses them where the database has more
  int threads = 0;                          ///< 0 = all cores; the result does not depend on it
};

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
  double strangeness = 1;  ///< mean patch distance over that of the strangest of a few members of the class
  bool trusted = true;     ///< false: the query is unlike the class
};

/// The depth of one image by example (thesis 4.1): every patch of image and
/// depth shall look like one of the examples.
/// @throws UserError  an image, mask or weight that cannot be used, or too
///                    little of the query is foreground
DepthResult reconstruct_depth(const DepthQuery& query, examples::ExampleSource& source, const DepthOptions& options,
                              Progress& progress);

}  // namespace parts::depth
