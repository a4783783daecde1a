// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mend/region.h"

namespace parts::mend {

/// Whether a hole has so few edges that no detail fits into it at the scan's own resolution.
bool is_small(const mesh::Loop& rim);

/// Closes such holes by a face, or a fan around their middle.
Scan close_small(const Scan& scan, const std::vector<mesh::Loop>& rims);

}  // namespace parts::mend
