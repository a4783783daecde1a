// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/colorize/mesh_options.h"
#include "parts/examples/class_models.h"
#include "parts/synthesis/patch_image.h"

namespace parts::colorize {

/// As large as in the class and standing like it, its middle in the origin: in
/// the frame of the views.
/// @throws UserError  coordinates that are not finite, or all in one point
examples::ClassModel pose(const Mesh& mesh, const examples::ClassModels& models, const ColorizeMeshOptions& options);

/// Pixels a unit of the frame: that of the class, less if the query needs more room.
double frame_for(const examples::ClassModel& query, const examples::ClassModels& models,
                 const ColorizeMeshOptions& options);

/// What the views show of a model. @param frame  see render_example
std::vector<examples::Example> see(const examples::ClassModel& model, double frame,
                                   const std::vector<render::View>& views, const examples::ExampleOptions& rendering);

/// color_planes of each.
std::vector<synthesis::PatchImage> planes_of(const std::vector<examples::Example>& views);

}  // namespace parts::colorize
