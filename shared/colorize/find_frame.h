// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "parts/colorize/mesh_options.h"
#include "parts/examples/class_models.h"

namespace parts::colorize {

/// How a mesh stands.
struct Standing {
  Vec3 up, front;
};

/// Along which axes a mesh stands: of the 24 ways the one in which silhouette and
/// relief, from the front and the side, are most like models of the class.
/// @param posed  the mesh as options.up and front have it, in the frame of the views
/// @return nothing where it stands already as members of the class do, or where
///         no other way is much more like them
std::optional<Standing> find_frame(const Mesh& posed, examples::ClassModels& models,
                                   const ColorizeMeshOptions& options);

}  // namespace parts::colorize
