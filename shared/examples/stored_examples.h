// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "parts/examples/examples.h"

namespace parts::examples {

/// Opens a mapping database: a project whose rasters have an RGBA plane and a
/// DEPTH_F plane (and MASK_UB, EXTRA00_F where there are such) and a camera.
/// Rasters without depth are left out and logged. Rasters with the same label
/// but for the view in it ("name 30,-15") are views of one object.
/// @throws UserError  no such project, no such raster in it, a file is missing,
///                    sizes differ
std::unique_ptr<ExampleSource> open_mapping_database(const std::string& path, Progress& progress);

}  // namespace parts::examples
