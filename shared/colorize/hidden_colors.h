// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/examples/class_models.h"

namespace parts::colorize {

/// Y, Cb and Cr, 0..1, of B, G and R, 0..255.
Eigen::Vector3f to_ycbcr(const Eigen::Vector3f& bgr);

/// Completes the colours of a mesh's vertices. A hidden vertex takes the colour
/// of a model's surface where that is closest, and a correction that continues
/// the difference between mesh and model at the vertices around, harmonically.
/// @param posed   the mesh, its vertices in the model's world space
/// @param known   per vertex
/// @param color   Y, Cb and Cr of each vertex, 0..1; those not known are found
/// @return false: the correction could not be solved for; the model's colours stand as they are
bool complete_colors(const Mesh& posed, const std::vector<char>& known, const examples::ClassModel& model,
                     std::vector<Eigen::Vector3f>& color, int threads);

}  // namespace parts::colorize
