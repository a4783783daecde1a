// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "parts/mesh/mesh.h"

namespace parts::test {

using ScalarField = std::function<double(const Vec3&)>;

/// By central differences over 2e-4.
Vec3 gradient(const ScalarField& field, const Vec3& p);

/// A closed mesh of the surface field = 0, simplified by collapsing short edges,
/// so that edges are about as long as `length` says at their place; even
/// triangles, vertices on the surface. Attributes of vertices are lost.
Mesh simplified(const Mesh& mesh, const ScalarField& field, const ScalarField& length);

}  // namespace parts::test
