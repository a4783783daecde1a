// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// The cotangent Laplacian of a surface and the areas of its vertices: the mean
/// curvature normal at vertex v is (matrix * x)_v / (2 area_v). Cotangents are bounded, so
/// that needles do not make systems worse than the surface is.
struct Laplacian {
  Eigen::SparseMatrix<double> matrix;  ///< symmetric, positive semidefinite, rows sum to 0
  Eigen::VectorXd area;                ///< per vertex: a third of its faces', world units squared
};
Laplacian laplacian(const std::vector<Vec3>& points, const std::vector<Triangle>& faces);

}  // namespace parts::mesh
