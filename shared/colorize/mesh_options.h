// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/colorize/options.h"
#include "parts/examples/options.h"
#include "parts/mesh/mesh.h"
#include "parts/render/camera.h"

namespace parts::colorize {

struct ColorizeMeshOptions : ColorizeOptions {
  Vec3 up{0, 1, 0}, front{0, 0, 1};    ///< how the mesh stands; rendering.up and front say how the models do
  bool find_frame = false;             ///< along which axes it stands is found where it is much more like the class so
  std::vector<render::View> views;     ///< from which the surface is seen and coloured
  examples::ExampleOptions rendering;  ///< size of the views, how the models stand; light is not used
  bool align = true;                   ///< the mesh is moved onto the model most like it, for the comparison
  std::vector<char> keep;              ///< per face: its own colours stay, and the others go with them; empty: none
};

}  // namespace parts::colorize
