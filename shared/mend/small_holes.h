// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mend/region.h"

namespace parts::mend {

/// Whether a hole has so few edges that no detail fits into it at the scan's own resolution.
bool is_small(const mesh::Loop& rim);

struct SmallHoles {
  Scan scan;
  std::vector<char> closed;  ///< per rim
};

/// Closes such holes by a face, a fan around their middle, or a fan from a
/// corner: the first of these that crosses nothing and makes no edge of more than
/// two faces. Where each does the hole stays.
SmallHoles close_small(const Scan& scan, const std::vector<mesh::Loop>& rims);

}  // namespace parts::mend
