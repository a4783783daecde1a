// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/base/progress.h"
#include "parts/mend/matching.h"

namespace parts::mend {

struct FitOptions {
  bool rigid = true;     ///< a similarity first, then the smooth field
  bool scale = true;     ///< the similarity may change the size
  bool smooth = true;    ///< the smooth field; false: only the similarity
  bool robust = true;    ///< what does not match counts less; false: all of the model is to come to lie on the target
  double finest = 0.06;  ///< of the field's lengths (0.7, 0.25, 0.08, each of half the size) none below this is used
  int threads = 0;       ///< 0 = all cores; the result does not depend on it
};

/// A model brought onto a scan.
struct Fitted {
  std::vector<Vec3> vertices;            ///< the model's, moved
  double rms_before = 0, rms_after = 0;  ///< distance of the matched vertices, world units
  double moved = 0;                      ///< RMS displacement of all vertices by the smooth field, world units
  double share = 0;                      ///< of the vertices that face good surface, those that match it
};

/// Fits a model that is nearly in place to the surface around a flaw or a hole
/// (beyond the thesis, which pastes it as it is): closest points on the good
/// surface say where the model's vertices should be, robustly, and a biharmonic
/// field carries those displacements on over the flaw, coarse to fine. The
/// model's details ride on it.
/// @param model  every vertex belongs to a face
/// @throws Cancelled
Fitted fit_to_rim(const Mesh& model, const FitTarget& target, const FitOptions& options, Progress& progress);

}  // namespace parts::mend
