// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "parts/mend/restore.h"

namespace parts::mend {

/// Whether a hole is one of two through the walls of a hollow shell: another
/// rim of about its length lies in the region and faces the other way.
bool is_through_a_wall(const Scan& scan, const Region& region);

/// A wall of a scan by itself, turned over: what faces inwards is like a model
/// once it faces outwards.
struct InnerWall {
  Scan scan;
  Region region;                ///< there
  std::vector<int> old_vertex;  ///< per vertex of that scan's mesh: its number in the whole scan's
  std::vector<int> old_face;
};

/// The wall that a rim belongs to: of the surface around the region what hangs together with it.
std::optional<InnerWall> inner_wall(const Scan& scan, const Region& region);

/// What mended a wall, in the whole scan, turned back. @return as of the whole
Restored put_back(const Scan& scan, const InnerWall& wall, Restored restored);

}  // namespace parts::mend
