// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"

namespace parts {

struct BlendOptions {
  double size = 0;  ///< of the region, world units
  int threads = 0;  ///< 0 = all cores; the result does not depend on it
};

struct Blended {
  std::vector<Vec3> vertices;  ///< of the base
  int models = 1;              ///< how many took part, the base among them
};

/// Blends models where they agree (beyond the thesis): the base is brought onto
/// each of the others, so that all are shapes of one mesh, and of all shapes
/// that their mean and differences make, the likeliest given the scan around
/// the flaw or hole is taken (a ridge regression on the distances to it, as in
/// Blanz and Vetter's morphable models). What lies over the hole follows.
/// Models that the base cannot be brought onto are left out.
/// @param base    the best model, rigidly placed; every vertex belongs to a face
/// @param others  placed likewise
/// @param flaw    per face of the scan: 1 = damaged; empty = none is
/// @throws Cancelled
Blended blend_models(const Mesh& base, const std::vector<Mesh>& others, const Mesh& scan, const std::vector<char>& flaw,
                     const BlendOptions& options, Progress& progress);

}  // namespace parts
