// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "parts/mesh/mesh.h"

namespace parts::spatial {

/// The point of a triangle that is closest to p, by the Voronoi regions of
/// corners, sides and inside (Ericson, "Real-Time Collision Detection", 5.1.5).
/// A triangle without area answers with a point of one of its sides.
Vec3 closest_on_triangle(const std::array<Vec3, 3>& t, const Vec3& p);

}  // namespace parts::spatial
