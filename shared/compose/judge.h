// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/compose/compose.h"
#include "parts/cut/seam_score.h"

namespace parts::compose {

/// What a surface is made of.
struct SurfaceFigures {
  int pieces = 0;  ///< components of faces joined by edges
  int border_loops = 0;
  int bad_elements = 0;  ///< non-manifold edges and vertices, edges whose faces disagree
  long crossings = 0;    ///< pairs of faces that touch or cross where they should not
};
SurfaceFigures figures_of(const Mesh& mesh, int threads);

/// A composition beside its inputs.
struct Judgement {
  cut::SeamScore seam;        ///< the objective J
  double unfaced_length = 0;  ///< of borders that face none, world units
  SurfaceFigures a, b, result;
};

/// @param result  with its clipped parts
Judgement judge(const Mesh& a, const Mesh& b, const ComposeResult& result, int threads);

/// A sentence for each way in which a result is worse than what it was made from.
/// @param inputs   sums over the inputs
/// @param stitched whether the inputs should be one now
std::vector<std::string> shortcomings(const SurfaceFigures& inputs, const SurfaceFigures& result, bool stitched);

}  // namespace parts::compose
