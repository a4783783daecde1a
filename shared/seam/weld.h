// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/seam/joined.h"

namespace parts::seam {

/// Welds contours that the cut made of both models along the same points, as
/// where they cross or are one surface: B's vertices there become A's. What
/// was welded is in the loops no more. Vertices all of whose faces lie on the
/// other model too stay where they are from then on: there is no seam to smooth.
/// @param step  world units: what is nearer is one place
void weld_borders(Joined& joined, double step, SeamReport& report);

}  // namespace parts::seam
