// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/mesh_cut.h"
#include "parts/seam/clip.h"

namespace parts::compose {

/// Clips a model at its border: where the values' zero set passes a face, it is
/// split along it; vertices with the value zero lie on the border.
/// @param crumb  world units: smaller pieces that the border makes are dropped
seam::Clipped clip_border(const cut::MeshBorder& border, const std::vector<char>& keep, double crumb);

}  // namespace parts::compose
