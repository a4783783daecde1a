// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// On which side of the plane through a, b, c the point d lies: 1 where the
/// triangle looks clockwise from d (behind it), -1 in front, 0 on the plane.
/// Exact for all finite coordinates between 1e-90 and 1e90: a filter, then expansion
/// arithmetic (Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast
/// Robust Geometric Predicates", 1997).
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The turn a, b, c as seen along an axis (0, 1, 2 = x, y, z; the points are
/// projected on the other two): 1 counter-clockwise, -1 clockwise, 0 straight. Exact.
int turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

/// Whether a, b, c lie on one line. Exact.
bool collinear(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace parts::mesh
