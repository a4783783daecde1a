// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "parts/mend/restore.h"

namespace parts::mend {

/// Of a hole that is one of two through the walls of a hollow shell, the rim in
/// the other wall: of about its length, within the region, facing the other way.
/// @return its vertices' places; empty: there is none
std::vector<Vec3> rim_in_other_wall(const Scan& scan, const Region& region);

/// A wall of a scan by itself, turned over: what faces inwards is like a model
/// once it faces outwards.
struct InnerWall {
  Scan scan;
  Region region;                ///< there
  std::vector<int> old_vertex;  ///< per vertex of that scan's mesh: its number in the whole scan's
  std::vector<int> old_face;
};

/// The wall that a rim belongs to: of the surface around the region, as far as
/// the walls do not meet, what hangs together with it.
/// @param other  rim_in_other_wall()
std::optional<InnerWall> inner_wall(const Scan& scan, const Region& region, const std::vector<Vec3>& other);

/// What mended a wall, in the whole scan, turned back. @return as of the whole
Restored put_back(const Scan& scan, const InnerWall& wall, Restored restored);

}  // namespace parts::mend
