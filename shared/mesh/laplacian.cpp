// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/laplacian.h"

#include <algorithm>

namespace parts::mesh {

Laplacian laplacian(const std::vector<Vec3>& points, const std::vector<Triangle>& faces) {
  constexpr double kLeast = 0.01, kMost = 10;  // half cotangents
  const int n = int(points.size());
  Laplacian l{Eigen::SparseMatrix<double>(n, n), Eigen::VectorXd::Zero(n)};
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(12 * faces.size());
  for (const Triangle& f : faces) {
    const double twice = (points[f[1]] - points[f[0]]).cross(points[f[2]] - points[f[0]]).norm();
    for (int k = 0; k < 3; ++k) {
      l.area[f[k]] += twice / 6;
      const int i = f[(k + 1) % 3], j = f[(k + 2) % 3];
      const double dot = (points[i] - points[f[k]]).dot(points[j] - points[f[k]]);
      const double cot = std::clamp(0.5 * dot / std::max(twice, 1e-300), kLeast, kMost);
      entries.emplace_back(i, j, -cot), entries.emplace_back(j, i, -cot);
      entries.emplace_back(i, i, cot), entries.emplace_back(j, j, cot);
    }
  }
  l.matrix.setFromTriplets(entries.begin(), entries.end());
  return l;
}

}  // namespace parts::mesh
