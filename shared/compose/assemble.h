// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/compose/compose.h"
#include "parts/seam/clip.h"

namespace parts::compose {

/// What the seam is measured by.
struct SeamMeasure {
  double edge;      ///< world units: its edges' length
  double max_gap;   ///< world units: borders farther apart do not face each other
  double step = 0;  ///< world units: borders no farther apart than this share their points
};

/// A composition and what is wrong with its seam.
struct Assembly {
  ComposeResult result;
  double flaws = 0;  ///< world units: borders that face none, and an edge for each pair of crossing faces
};

/// Puts two clipped models into one mesh and, where the options say so,
/// stitches and smooths the seam (thesis 3.2.5). Adds to what the assembly's report holds.
void assemble(const cut::Model& a, seam::Clipped clipped_a, const cut::Model& b, seam::Clipped clipped_b,
              const SeamMeasure& measure, const ComposeOptions& options, Progress& progress, Assembly& assembly);

/// A model clipped along its edges.
/// @param faces  per face of the part that the model was made from: 1 = stays
seam::Clipped take_model_faces(const cut::Model& model, const std::vector<char>& faces);

}  // namespace parts::compose
