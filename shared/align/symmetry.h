// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <vector>

#include "parts/base/progress.h"
#include "parts/mesh/mesh.h"

namespace parts::align {

/// A plane in which a surface is about its own mirror image.
struct Symmetry {
  Vec3 normal = Vec3::UnitX();  ///< unit length
  Vec3 point = Vec3::Zero();    ///< on the plane, world units
  /// RMS distance between the surface and its reflection, of the share kSymmetric
  /// that lies closest, world units.
  double residual = 0;
  double size = 1;  ///< of the surface: its RMS radius, world units

  /// Takes a point to its mirror image.
  Eigen::Affine3d reflection() const;
  double distance(const Vec3& p) const { return std::abs(normal.dot(p - point)); }
  /// Heads differ from their reflections by 0.01 to 0.03 of their size, shapes without symmetry by 0.1.
  bool holds() const { return residual < 0.05 * size; }
};

/// Of the surface beyond no border, so much is asked to have its mirror image: the rest may be damage.
constexpr double kSymmetric = 0.8;

/// The planes of bilateral symmetry, the best first: the surface is laid on its
/// reflections by trimmed ICP from the principal planes and others spread over
/// all directions, each result made a reflection again. What lies opposite to a
/// hole has no counterpart and does not count. Planes that are alike (within 15
/// degrees) are one.
/// @param flags    a flag a face: 1 = counts; all where none is
/// @param most     how many planes
/// @param threads  0 = all cores; the result does not depend on it
/// @throws UserError  no face with area; @throws Cancelled
std::vector<Symmetry> find_symmetries(const Mesh& mesh, const std::vector<char>& flags, int most, int threads,
                                      Progress& progress);

}  // namespace parts::align
