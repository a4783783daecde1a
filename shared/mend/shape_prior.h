// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::mend {

/// A vertex seen to lie in a plane: the surface there is known, where on it the vertex lies is not.
struct PlaneObservation {
  int vertex = 0;
  Vec3 point, normal;  ///< of the plane, world units; unit length
  double noise = 0;    ///< standard deviation along the normal, world units
};

/// What shapes a mesh may take, told from some of its shapes: a Gaussian
/// process over its vertices (Luethi et al., "Gaussian Process Morphable
/// Models", 2018) whose mean is that of the shapes and whose covariance is
/// theirs plus that of a rough isotropic field, for what no blend of them
/// explains.
class ShapePrior {
 public:
  /// @param shapes  at least one; vertices of one mesh, corresponding
  /// @param weight  of each, their sum 1
  /// @param size    of the region that matters, world units
  ShapePrior(const std::vector<std::vector<Vec3>>& shapes, const std::vector<double>& weight, double size);

  const std::vector<Vec3>& mean() const { return mean_; }

  /// The likeliest shape once some vertices have been seen: all vertices.
  std::vector<Vec3> given(const std::vector<PlaneObservation>& seen) const;

 private:
  /// The covariance of the isotropic field between two places.
  double rough(const Vec3& a, const Vec3& b) const;

  std::vector<Vec3> mean_;
  Eigen::MatrixXd differences_;  ///< 3 rows a vertex, a column a shape: from the mean, times the root of its weight
  double size_;
};

}  // namespace parts::mend
