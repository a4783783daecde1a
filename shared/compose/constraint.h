// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::compose {

/// The ways to say which faces of a model must survive. A constraint is a part
/// of the surface, so it stays valid when the model moves (thesis 3.1).
enum class ConstraintBy { SelectedFaces, SelectedVertices, Box };

/// What a mark says of the faces: they must survive, or they must go.
enum class Mark { Keep, Drop };

/// One flag a face. Selected vertices mark the faces around them; a box marks
/// the faces that it touches; a box with min = max is a point and marks the
/// face nearest to it.
/// @param model  the model's name in error sentences: "model A", "the fixed part"
/// @throws UserError  nothing is marked, or the box is inverted or not finite
std::vector<char> constrained_faces(const Mesh& mesh, ConstraintBy by, const Vec3& box_min, const Vec3& box_max,
                                    const char* model, Mark mark = Mark::Keep);

}  // namespace parts::compose
