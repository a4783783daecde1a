// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/band.h"

#include <queue>
#include <unordered_map>

namespace parts::seam {
namespace {

/// Neighbours and borders of all that may belong to the band.
void connect(const Mesh& mesh, const Box& reach, double distance, Band& band) {
  std::vector<char> close(mesh.vertices.size(), 0);
  for (int v = 0; v < mesh.vertex_count(); ++v) close[v] = reach.exteriorDistance(mesh.vertices[v]) <= distance;
  std::unordered_map<long long, int> sides;  // of edges, to find the border
  for (const Triangle& f : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      const int u = f[k], v = f[(k + 1) % 3];
      if (!close[u] && !close[v]) continue;
      if (++sides[(long long)(std::min(u, v)) << 32 | std::max(u, v)] == 1)
        band.around[u].push_back(v), band.around[v].push_back(u);
    }
  for (const auto& [edge, count] : sides)
    if (count != 2) band.on_border[edge >> 32] = band.on_border[int(edge & 0xffffffff)] = 1;
}

}  // namespace

Band band_around(const Mesh& mesh, const std::vector<char>& seam, double distance) {
  const std::size_t n = mesh.vertices.size();
  Band band{{}, std::vector<double>(n, Band::kBeyond), std::vector<std::vector<int>>(n), std::vector<char>(n, 0)};
  Box reach;
  for (std::size_t v = 0; v < n; ++v)
    if (seam[v]) reach.extend(mesh.vertices[v]);
  if (reach.isEmpty()) return band;
  connect(mesh, reach, distance, band);
  // Dijkstra along edges.
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (int v = 0; v < int(n); ++v)
    if (seam[v]) queue.push({band.away[v] = 0, v});
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > band.away[v]) continue;
    band.vertices.push_back(v);
    for (int u : band.around[v])
      if (const double e = d + (mesh.vertices[u] - mesh.vertices[v]).norm(); e < band.away[u] && e < distance)
        queue.push({band.away[u] = e, u});
  }
  return band;
}

}  // namespace parts::seam
