// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mend/restore.h"

namespace parts::mend {

/// A mesh with some vertices moved to the fairest surface that goes on from the
/// others with their slopes: of least bending (bilaplacian), as hole fillers
/// make it (Botsch and Kobbelt, "An intuitive framework for real-time freeform modeling", 2004).
/// @param free  per vertex: 1 = moves
/// @return its vertices; as they were where that cannot be solved
std::vector<Vec3> faired(const Mesh& mesh, const std::vector<char>& free);

/// How well fills foretell sound surface: a band of it beside the patch is left
/// out, filled with it, and compared with what is there.
struct Foresight {
  double model = 0, fair = 0;  ///< RMS distance of the band from the model, from the fair surface, world units
};

/// @param restored  a patch that closes the scan, and where its faces are from
/// @param model     that made it, in place
/// @throws Cancelled
Foresight foresee(const Scan& scan, const Region& region, const Restored& restored, const PlacedModel& model,
                  const FittingOptions& options, Progress& progress);

}  // namespace parts::mend
