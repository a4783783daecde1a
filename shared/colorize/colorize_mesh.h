// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/base/progress.h"
#include "parts/colorize/mesh_colors.h"
#include "parts/colorize/mesh_options.h"
#include "parts/examples/class_models.h"

namespace parts::colorize {

/// Finds colours for a whole mesh from coloured models of its class (thesis 6.3):
/// all views are one synthesis, in which pixels that show the same point of the
/// surface have one colour, so that views agree and leave no seams. What no view
/// sees takes the colours of the model most like it at the same place, adapted to
/// the colours around.
/// @throws UserError  a mesh without surface, no model with colours, …
MeshColors colorize_mesh(const Mesh& mesh, examples::ClassModels& models, const ColorizeMeshOptions& options,
                         Progress& progress);

}  // namespace parts::colorize
