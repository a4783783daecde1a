// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "compose/compose.h"

namespace parts {

/// Removes slivers along a seam: edges at seam vertices shorter than `shortest`
/// are collapsed where that keeps the surface manifold and turns no face over,
/// and edges between seam faces are flipped where that opens the smallest
/// angles. Vertices with fixed = 1 stay where they are, and so do all faces
/// around which no seam vertex lies.
/// @param tag  per face, follows the faces
void tidy_seam(Mesh& mesh, std::vector<char>& seam, std::vector<char>& fixed, std::vector<char>& tag, double shortest);

/// Averages vertices near the seam with their neighbours (thesis 3.2.5). The
/// effect fades from the seam to `distance`; fixed and boundary vertices stay.
void smooth_seam(Mesh& mesh, const std::vector<char>& seam, const std::vector<char>& fixed, double distance,
                 int iterations, double weight);

}  // namespace parts
