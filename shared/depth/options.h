// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/render/camera.h"

namespace parts::depth {

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

}  // namespace parts::depth
