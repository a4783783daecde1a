// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "parts/examples/example.h"
#include "parts/examples/render_example.h"
#include "parts/io/model_database.h"

namespace parts::examples {

/// Renders examples of the models of a database as they are asked for.
///
/// All models are framed alike. Models within a factor 2 of the median size
/// share one scale, so that a tall man is taller than a small one; others (in
/// other units, say) are drawn as large as the median one. The frame is the
/// largest in which every model fits, in the views given and up to 35 degrees of
/// yaw and 25 of pitch around them.
/// @param views    from which to frame
/// @param options  up and front count where the class's preset does not say
/// @throws UserError  no model can be read; more memory than there is
std::unique_ptr<ExampleSource> render_examples(const io::ModelDatabase& database,
                                               const std::vector<render::View>& views, const ExampleOptions& options,
                                               Progress& progress);

/// A project with a raster that has a depth plane is a mapping database; any
/// other project, and any folder, a database of models to render.
std::unique_ptr<ExampleSource> open_examples(const std::string& path, const std::vector<render::View>& views,
                                             const ExampleOptions& options, Progress& progress);

}  // namespace parts::examples
