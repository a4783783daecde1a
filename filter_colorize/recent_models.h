// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "parts/examples/class_models.h"

namespace parts {

/// The models of a database as last time, where nothing about it has changed:
/// many filters of one script read it once. What reading it logged is logged again.
std::shared_ptr<examples::ClassModels> recent_models(const io::ModelDatabase& database,
                                                     const std::vector<render::View>& views,
                                                     const examples::ExampleOptions& options, Progress& progress);

}  // namespace parts
