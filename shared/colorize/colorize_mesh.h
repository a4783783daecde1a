// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/base/progress.h"
#include "parts/colorize/mesh_colors.h"
#include "parts/colorize/options.h"
#include "parts/examples/class_models.h"

namespace parts::colorize {

struct ColorizeMeshOptions : ColorizeOptions {
  Vec3 up{0, 1, 0}, front{0, 0, 1};    ///< how the mesh stands
  std::vector<render::View> views;     ///< from which the surface is seen and coloured
  examples::ExampleOptions rendering;  ///< size of the views, how the models stand; light is not used
  bool align = true;                   ///< the mesh is moved onto the model most like it, for the comparison
  std::vector<char> keep;              ///< per face: its own colours stay, and the others go with them; empty: none
};

/// Finds colours for a whole mesh from coloured models of its class (thesis 6.3):
/// all views are one synthesis, in which pixels that show the same point of the
/// surface have one colour, so that views agree and leave no seams. What no view
/// sees takes the colours of the model most like it at the same place, adapted to
/// the colours around.
/// @throws UserError  a mesh without surface, no model with colours, …
MeshColors colorize_mesh(const Mesh& mesh, examples::ClassModels& models, const ColorizeMeshOptions& options,
                         Progress& progress);

}  // namespace parts::colorize
