// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// Whether two corners of a polygon may be joined by a new edge.
using MayJoin = std::function<bool(int, int)>;

/// Cuts a polygon in space into triangles between its own corners, ear by ear:
/// of those that are ears as seen along the polygon's normal the one with the
/// shortest chord for its sides first, then, where the polygon crosses itself or
/// is flat, any. In time quadratic at worst, mostly far less.
/// @param corners   in order, the first not repeated
/// @param may_join  optional; chords for which it is false are not made
/// @return triangles of positions in `corners`, that run as the polygon does:
///         each from its first corner on; two fewer than corners, or none if `may_join` leaves no way
std::vector<Triangle> cut_ears(const std::vector<Vec3>& corners, const MayJoin& may_join = {});

}  // namespace parts::mesh
