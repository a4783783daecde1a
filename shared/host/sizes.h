// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "parts/mesh/mesh.h"

/// What comes in is checked once that it can be computed with.
namespace parts::host {

/// Volumes of models this large (and of 1 / this) are numbers in single precision.
constexpr double kLargestSize = 1e12;

/// Between neighbouring numbers as the host keeps coordinates.
double coordinate_step_at(double at);

/// @param name  of a parameter, a length or coordinates
/// @throws UserError  it is too large to compute with
void check_size(const std::string& name, double value);

/// The surface in world space; vertices that no face uses do not count.
/// @param step  see coordinate_step()
/// @throws UserError  it is too large, too small, or so far from the origin that
///                    its coordinates, as the host keeps them, do not hold its shape
void check_sizes(const Mesh& mesh, double step, const std::string& layer);

}  // namespace parts::host
