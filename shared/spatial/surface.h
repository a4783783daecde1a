// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::spatial {

/// A point of a surface and the unit normal of its face.
struct Sample {
  Vec3 point, normal;
};

/// The emphasised faces of a model in a frame of their own, where numbers are
/// near 1 whatever the model's units: centroid at the origin, RMS distance of
/// the surface from it 1. Centroid and covariance are integrals over the area,
/// in closed form for each triangle: the tessellation does not matter.
struct Surface {
  std::vector<std::array<Vec3, 3>> triangles;  ///< (world - origin) / size; none of zero area
  std::vector<Vec3> normals;                   ///< unit, one a triangle
  std::vector<double> area_up_to;              ///< cumulative, one a triangle
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  Vec3 origin = Vec3::Zero();  ///< world
  double size = 1;             ///< world units

  double area() const { return area_up_to.back(); }
};

/// @param flags  1 = emphasised; none = every face
/// @param model  the model's name in error sentences: "moving", "fixed"
/// @throws UserError  no face, a non-finite coordinate, no area
Surface make_surface(const Mesh& mesh, const std::vector<char>& flags, const char* model);

/// count points, uniform over the area, always the same. Every prefix is
/// uniform too (a low-discrepancy sequence), so a coarse level takes the first few.
std::vector<Sample> sample_surface(const Surface& surface, int count);

/// Columns: the principal axes of a covariance, largest variance first, right-handed.
Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& covariance);

}  // namespace parts::spatial
