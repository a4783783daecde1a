// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/transition_surface.h"

#include <algorithm>
#include <unordered_map>

namespace parts::cut {
namespace {

constexpr int kFinest = 128;

/// Labels of all voxels of a grid, grown from those that have one, step by step
/// in index order.
std::vector<std::int8_t> grown_labels(const Grid& grid, std::vector<std::int8_t> label) {
  std::vector<std::size_t> front;
  for (std::size_t v = 0; v < label.size(); ++v)
    if (label[v]) front.push_back(v);
  while (!front.empty()) {
    std::vector<std::size_t> next;
    for (std::size_t v : front) {
      const std::array<int, 3> c = grid.cell(v);
      for (int d = 0; d < 3; ++d)
        for (int s : {-1, 1}) {
          std::array<int, 3> n = c;
          n[d] += s;
          if (!grid.inside(n[0], n[1], n[2])) continue;
          const std::size_t u = grid.index(n[0], n[1], n[2]);
          if (!label[u]) label[u] = label[v], next.push_back(u);
        }
    }
    front.swap(next);
  }
  return label;
}

void smooth(Mesh& mesh, int rounds) {
  std::vector<Vec3> sum(mesh.vertices.size());
  std::vector<int> count(mesh.vertices.size());
  for (int round = 0; round < rounds; ++round) {
    std::fill(sum.begin(), sum.end(), Vec3::Zero());
    std::fill(count.begin(), count.end(), 0);
    for (const Triangle& f : mesh.faces)
      for (int k = 0; k < 3; ++k) sum[f[k]] += mesh.vertices[f[(k + 1) % 3]], ++count[f[k]];
    for (std::size_t v = 0; v < sum.size(); ++v)
      if (count[v]) mesh.vertices[v] = 0.5 * (mesh.vertices[v] + sum[v] / count[v]);
  }
}

}  // namespace

Mesh transition_surface(const JointVoxels& voxels, const VoxelLabels& labels, int smoothing) {
  const Grid& fine = voxels.grid;
  const int longest = std::max({fine.dims[0], fine.dims[1], fine.dims[2]});
  const int factor = (longest + kFinest - 1) / kFinest;
  Grid grid = fine;
  grid.size *= factor;
  for (int& n : grid.dims) n = (n + factor - 1) / factor;
  std::vector<std::int8_t> label(grid.count(), 0);
  for (long n = 0; n < voxels.size(); ++n) {
    const std::array<int, 3> c = fine.cell(voxels.cells[n]);
    std::int8_t& l = label[grid.index(c[0] / factor, c[1] / factor, c[2] / factor)];
    if (!l) l = labels.label[n];
  }
  label = grown_labels(grid, std::move(label));

  Mesh mesh;
  std::unordered_map<std::size_t, int> corner;  // of the grid's corners, one more each way
  const auto vertex = [&](const std::array<int, 3>& c) {
    const std::size_t key = c[0] + std::size_t(grid.dims[0] + 1) * (c[1] + std::size_t(grid.dims[1] + 1) * c[2]);
    const auto [it, fresh] = corner.try_emplace(key, mesh.vertex_count());
    if (fresh) mesh.vertices.push_back(grid.origin + grid.size * Vec3(c[0], c[1], c[2]));
    return it->second;
  };
  for (std::size_t v = 0; v < label.size(); ++v) {
    const std::array<int, 3> c = grid.cell(v);
    for (int d = 0; d < 3; ++d) {
      if (c[d] + 1 >= grid.dims[d]) continue;
      std::array<int, 3> n = c;
      ++n[d];
      const std::int8_t here = label[v], there = label[grid.index(n[0], n[1], n[2])];
      if (here == there || !here || !there) continue;
      // The side's corners, counter-clockwise seen from +d.
      std::array<int, 4> q;
      const int u = (d + 1) % 3, w = (d + 2) % 3;
      for (int k = 0; k < 4; ++k) {
        std::array<int, 3> p = n;
        p[u] += k == 1 || k == 2, p[w] += k >= 2;
        q[k] = vertex(p);
      }
      if (here == VoxelLabels::kA) std::swap(q[1], q[3]);
      mesh.faces.push_back({q[0], q[1], q[2]});
      mesh.faces.push_back({q[0], q[2], q[3]});
    }
  }
  smooth(mesh, smoothing);
  return mesh;
}

}  // namespace parts::cut
