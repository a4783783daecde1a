// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "parts/mesh/mesh.h"

/// MeshLab's own ways to close holes, by the staged meshlabserver.
/// @param folder  where the files that pass between go
/// @throws std::runtime_error  MeshLab failed, or took longer than two minutes
namespace parts::bench {

/// "Close Holes" with its defaults, holes of any size.
Mesh close_holes(const Mesh& scan, const std::string& folder);
/// "Surface Reconstruction: Screened Poisson" with its defaults, of the scan's vertices.
Mesh screened_poisson(const Mesh& scan, const std::string& folder);

}  // namespace parts::bench
