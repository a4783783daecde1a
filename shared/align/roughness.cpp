// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/align/roughness.h"

#include <algorithm>
#include <cmath>

#include "parts/base/median.h"

namespace parts::align {

double roughness(const Mesh& mesh, const std::vector<char>& flags) {
  constexpr int kFewest = 4;  // faces around a vertex, or it lies at a border
  const bool all = std::find(flags.begin(), flags.end(), 1) == flags.end();
  const std::size_t n = mesh.vertices.size();
  std::vector<Vec3> around(n, Vec3::Zero()), normal(n, Vec3::Zero());
  std::vector<int> faces(n, 0);
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!all && !flags[f]) continue;
    const Triangle& t = mesh.faces[f];
    for (int k = 0; k < 3; ++k) {
      around[t[k]] += mesh.vertices[t[(k + 1) % 3]] + mesh.vertices[t[(k + 2) % 3]];
      normal[t[k]] += mesh.normal(f);
      ++faces[t[k]];
    }
  }
  std::vector<double> off;
  for (std::size_t v = 0; v < n; ++v)
    if (faces[v] >= kFewest && normal[v].squaredNorm() > 0)
      off.push_back(std::abs(normal[v].normalized().dot(around[v] / (2.0 * faces[v]) - mesh.vertices[v])));
  return off.empty() ? 0 : median(std::move(off));
}

}  // namespace parts::align
