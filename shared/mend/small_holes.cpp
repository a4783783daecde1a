// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/small_holes.h"

#include "parts/mesh/attributes.h"
#include "parts/mesh/pinches.h"

namespace parts::mend {

bool is_small(const mesh::Loop& rim) {
  constexpr int kMostEdges = 6;
  return rim.size() <= kMostEdges;
}

Scan close_small(const Scan& scan, const std::vector<mesh::Loop>& rims) {
  if (rims.empty()) return scan;
  Mesh mesh = scan.mesh();
  std::vector<int> like(mesh.vertices.size(), -1);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f]) like[v] = f;
  for (const mesh::Loop& rim : rims) {
    const std::vector<int>& v = rim.vertices;
    const int n = rim.size();
    if (n == 3) {
      mesh::add_face_like(mesh, like[v[0]], {v[2], v[1], v[0]});
      continue;
    }
    Vec3 middle = Vec3::Zero();
    for (int u : v) middle += mesh.vertices[u] / n;
    const int center = mesh::add_vertex_between(mesh, v[0], v[n / 2], 0.5);
    mesh.vertices[center] = middle;
    for (int k = 0; k < n; ++k) mesh::add_face_like(mesh, like[v[k]], {rim.next(k), v[k], center});
  }
  std::vector<int> origin = scan.origin();
  origin.resize(mesh.faces.size(), kFromStitch);
  mesh::weld_steps(mesh, origin);
  return Scan(std::move(mesh), std::move(origin));
}

}  // namespace parts::mend
