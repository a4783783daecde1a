// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/slits.h"

#include <algorithm>
#include <cmath>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/loops.h"
#include "parts/mesh/prepare.h"

namespace parts::mesh {
namespace {

/// Whether all coordinates are multiples of the step, as nearly as single precision holds them.
bool multiples(const Mesh& mesh, double step) {
  constexpr double kHalfUlp = 1.0 / (1 << 24);
  for (const Vec3& p : mesh.vertices)
    for (int d = 0; d < 3; ++d) {
      const double steps = p[d] / step;
      if (!(std::abs(steps - std::round(steps)) <= kHalfUlp * std::abs(steps) + 1e-6)) return false;
    }
  return true;
}

/// Border vertices, sorted by x.
std::vector<int> border_vertices(const Mesh& mesh) {
  std::vector<int> border;
  for (const auto& e : boundary_half_edges(mesh)) border.push_back(e[0]), border.push_back(e[1]);
  std::sort(border.begin(), border.end(), [&](int a, int b) {
    const double x = mesh.vertices[a].x(), y = mesh.vertices[b].x();
    return x != y ? x < y : a < b;
  });
  border.erase(std::unique(border.begin(), border.end()), border.end());
  return border;
}

}  // namespace

double coordinate_step(const Mesh& mesh) {
  double largest = 0;
  for (const Vec3& p : mesh.vertices)
    if (p.allFinite()) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  if (!(largest > 0)) return 0;
  const double ulp = std::ldexp(1.0, std::ilogb(largest) - 23);
  for (double step = std::pow(10, std::floor(std::log10(largest))); step > 2 * ulp; step /= 10)
    if (multiples(mesh, step)) return step;
  return ulp;
}

int close_slits(Mesh& mesh, double reach) {
  const std::vector<int> border = border_vertices(mesh);
  const auto near = [&](int a, int b) { return (mesh.vertices[a] - mesh.vertices[b]).cwiseAbs().maxCoeff() <= reach; };
  DisjointSets sets(mesh.vertex_count());
  bool any = false;
  for (std::size_t i = 0; i < border.size(); ++i)
    for (std::size_t j = i + 1; j < border.size(); ++j) {
      if (mesh.vertices[border[j]].x() - mesh.vertices[border[i]].x() > reach) break;
      if (near(border[i], border[j])) sets.unite(border[i], border[j]), any = true;
    }
  if (!any) return 0;
  std::vector<char> stays(mesh.vertices.size(), 0);  // of a set that would swallow a face's side
  for (const Triangle& f : mesh.faces)
    for (int k = 0; k < 3; ++k)
      if (const int set = sets.find(f[k]); set == sets.find(f[(k + 1) % 3])) stays[set] = 1;
  int moved = 0;
  for (int v : border)
    if (const int first = sets.find(v); first != v && !stays[first] && mesh.vertices[v] != mesh.vertices[first])
      mesh.vertices[v] = Vec3(mesh.vertices[first]), ++moved;
  return moved;
}

Mesh prepare_without_slits(const Mesh& input) {
  constexpr double kSteps = 5, kOfDiagonal = 1e-5;
  Mesh mesh = prepare(input).mesh;
  if (mesh.faces.empty()) return mesh;
  const double reach = std::min(kSteps * coordinate_step(mesh), kOfDiagonal * mesh.bounds().diagonal().norm());
  return close_slits(mesh, reach) ? prepare(mesh).mesh : mesh;
}

}  // namespace parts::mesh
