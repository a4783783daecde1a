// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/base/progress.h"
#include "parts/mend/matching.h"

namespace parts::mend {

/// A model in two poses.
struct PosedModel {
  Mesh mesh;                 ///< rigidly placed in the scan; every vertex belongs to a face
  double rms = 0;            ///< distance to the scan around the flaw or hole in the rigid pose, world units
  std::vector<Vec3> fitted;  ///< its vertices, fitted to the scan around the flaw or hole
};

struct Blended {
  std::vector<Vec3> vertices;  ///< of the base
  int models = 1;              ///< how many took part, the base among them
};

/// Blends models where they agree (beyond the thesis): the base is brought onto
/// each of the others, so that all are shapes of one mesh, and of all shapes that
/// a ShapePrior makes of them the likeliest given the scan around the flaw or
/// hole is taken. What lies over the hole follows. Corresponding points are found
/// between the fitted poses, which are alike around the hole; the shapes are
/// those of the rigid ones. Models that are more like the scan there count more.
/// @param models  the first is the base, the best
/// @param threads  0 = all cores; the result does not depend on it
/// @throws Cancelled
Blended blend_models(const std::vector<PosedModel>& models, const FitTarget& target, int threads, Progress& progress);

}  // namespace parts::mend
