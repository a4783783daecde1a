// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/crossings.h"

#include "parts/cut/rasterize.h"

namespace parts::cut {
namespace {

/// (seam voxel's number, face) for all faces of a mesh that touch seam voxels, sorted.
std::vector<std::pair<int, int>> faces_in(const Mesh& mesh, const Grid& grid, const VoxelSet& seam) {
  std::vector<std::pair<int, int>> found;
  for (int f = 0; f < mesh.face_count(); ++f)
    for_each_voxel(grid, mesh, f, [&](std::size_t v) {
      if (const int s = seam.node(v); s >= 0) found.emplace_back(s, f);
    });
  std::sort(found.begin(), found.end());
  return found;
}

Vec3 unit_normal(const Mesh& m, int f) {
  return (m.corner(f, 1) - m.corner(f, 0)).cross(m.corner(f, 2) - m.corner(f, 0)).normalized();
}

/// Adds the points where edges of face f pierce face g.
void pierce(const Mesh& edges_of, int f, const Mesh& faces_of, int g, std::vector<Vec3>& points) {
  const Vec3 &a = faces_of.corner(g, 0), ab = faces_of.corner(g, 1) - a, ac = faces_of.corner(g, 2) - a;
  const Vec3 n = ab.cross(ac);
  for (int k = 0; k < 3; ++k) {
    const Vec3 &p = edges_of.corner(f, k), d = edges_of.corner(f, (k + 1) % 3) - p;
    const double slope = -d.dot(n);
    if (slope == 0) continue;
    const double t = (p - a).dot(n) / slope;
    if (!(t >= 0 && t <= 1)) continue;
    const Vec3 x = p + t * d - a;
    const double u = x.cross(ac).dot(n) / n.squaredNorm(), v = ab.cross(x).dot(n) / n.squaredNorm();
    if (u >= 0 && v >= 0 && u + v <= 1) points.push_back(x + a);
  }
}

}  // namespace

std::vector<Vec3> crossing_points(const Mesh& a, const Mesh& b, const JointVoxels& voxels, const VoxelLabels& labels) {
  constexpr double kClearAngle = 0.94;
  const Grid& grid = voxels.grid;
  // Across the sides of the seam voxels too: where the curve runs between two
  // layers of intersection voxels, the cut takes one.
  VoxelSet seam(grid.count());
  for (long n = 0; n < voxels.size(); ++n) {
    if (labels.label[n] != VoxelLabels::kSeam) continue;
    seam.add(voxels.cells[n]);
    const std::array<int, 3> c = grid.cell(voxels.cells[n]);
    for (int d = 0; d < 3; ++d)
      for (int s : {-1, 1}) {
        std::array<int, 3> q = c;
        q[d] += s;
        if (const int m = voxels.at(q[0], q[1], q[2]); m >= 0 && voxels.both(m)) seam.add(voxels.cells[m]);
      }
  }
  seam.index();
  const auto of_a = faces_in(a, grid, seam), of_b = faces_in(b, grid, seam);
  const std::vector<std::size_t> cells = seam.cells();

  std::vector<Vec3> points;
  std::size_t i = 0, j = 0;
  for (int s = 0; s < int(seam.size()); ++s) {
    const std::size_t i0 = i, j0 = j;
    while (i < of_a.size() && of_a[i].first == s) ++i;
    while (j < of_b.size() && of_b[j].first == s) ++j;
    for (std::size_t p = i0; p < i; ++p)
      for (std::size_t q = j0; q < j; ++q) {
        const int f = of_a[p].second, g = of_b[q].second;
        if (!a.face_box(f).intersects(b.face_box(g))) continue;
        if (!(std::abs(unit_normal(a, f).dot(unit_normal(b, g))) < kClearAngle)) continue;
        std::vector<Vec3> ends;
        pierce(a, f, b, g, ends);
        pierce(b, g, a, f, ends);
        if (ends.size() < 2) continue;
        // Only what lies in this voxel, so that no point counts twice; long
        // segments are sampled at half voxels.
        const Vec3 from = ends.front(), to = ends.back();
        const int steps = std::max(1, int(std::ceil(2 * (to - from).norm() / grid.size)));
        for (int k = 0; k <= steps; ++k) {
          const Vec3 x = from + (to - from) * k / steps, c = grid.to_grid(x);
          const int ci = int(std::floor(c[0])), cj = int(std::floor(c[1])), ck = int(std::floor(c[2]));
          if (grid.inside(ci, cj, ck) && grid.index(ci, cj, ck) == cells[s]) points.push_back(x);
        }
      }
  }
  return points;
}

}  // namespace parts::cut
