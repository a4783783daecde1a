// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/bits.h"
#include "parts/cut/grid.h"

namespace parts::cut {

/// The separating-axis test of one triangle against unit boxes, in voxel units
/// (Akenine-Möller 2001). Boxes are taken a hair larger than they are, so that
/// rounding never lets a surface slip between two voxels.
class TriangleBoxTest {
 public:
  TriangleBoxTest(const Vec3& a, const Vec3& b, const Vec3& c)
      : lo_(a.cwiseMin(b).cwiseMin(c)), hi_(a.cwiseMax(b).cwiseMax(c)) {
    const Vec3 edge[3] = {b - a, c - b, a - c};
    normal_ = edge[0].cross(edge[1]);
    for (int d = 0; d < 3; ++d)
      for (int e = 0; e < 3; ++e) {
        const int u = (d + 1) % 3, v = (d + 2) % 3;
        const double cu = edge[e][v], cv = -edge[e][u], r = kHalf * (std::abs(cu) + std::abs(cv));
        const double pa = cu * a[u] + cv * a[v], pb = cu * b[u] + cv * b[v], pc = cu * c[u] + cv * c[v];
        axis_[d][e] = {cu, cv, std::min({pa, pb, pc}) - r, std::max({pa, pb, pc}) + r};
      }
    // Of a needle the computed normal is noise, so all three corners have a say.
    const double pa = normal_.dot(a), pb = normal_.dot(b), pc = normal_.dot(c), r = kHalf * normal_.cwiseAbs().sum();
    plane_from_ = std::min({pa, pb, pc}) - r, plane_to_ = std::max({pa, pb, pc}) + r;
  }

  /// Calls visit(i, j, k) for every unit box in [0, dims) that the triangle
  /// touches; the work grows with the triangle's area, not with its box.
  template <class Visit>
  void for_each_box(const std::array<int, 3>& dims, const Visit& visit) const {
    std::array<int, 3> from, to;
    bool one = true;
    for (int d = 0; d < 3; ++d) {
      from[d] = int(std::floor(std::clamp(lo_[d] - kHair, -1.0, 2e9)));
      to[d] = int(std::floor(std::clamp(hi_[d] + kHair, -1.0, 2e9)));
      one &= from[d] == to[d];
      from[d] = std::max(from[d], 0), to[d] = std::min(to[d], dims[d] - 1);
      if (from[d] > to[d]) return;
    }
    if (one) return void(visit(from[0], from[1], from[2]));
    int w;  // the axis along which the triangle is flattest: few boxes a column
    normal_.cwiseAbs().maxCoeff(&w);
    const int u = (w + 1) % 3, v = (w + 2) % 3;
    for (int iv = from[v]; iv <= to[v]; ++iv)
      for (int iu = from[u]; iu <= to[u]; ++iu) {
        const double cu = iu + 0.5, cv = iv + 0.5;
        if (separated(w, cu, cv)) continue;
        int w0 = from[w], w1 = to[w];
        if (normal_[w] != 0) {
          const double part = normal_[u] * cu + normal_[v] * cv;
          double c0 = (plane_from_ - part) / normal_[w], c1 = (plane_to_ - part) / normal_[w];
          if (c0 > c1) std::swap(c0, c1);
          w0 = std::max(w0, int(std::ceil(std::max(c0 - 0.5 - kHair, -1.0))));
          w1 = std::min(w1, int(std::floor(std::min(c1 - 0.5 + kHair, 2e9))));
        }
        for (int iw = w0; iw <= w1; ++iw) {
          const double cw = iw + 0.5;
          if (separated(u, cv, cw) || separated(v, cw, cu)) continue;
          std::array<int, 3> c;
          c[u] = iu, c[v] = iv, c[w] = iw;
          visit(c[0], c[1], c[2]);
        }
      }
  }

 private:
  static constexpr double kHair = 1e-6, kHalf = 0.5 + kHair;

  /// An axis across coordinate axis d, as it has no part along it: that of an
  /// edge crossed with d. In the two other coordinates, in cyclic order.
  struct Axis {
    double cu, cv, from, to;
  };

  /// Whether an axis across d parts the triangle from the box centred at (u, v).
  bool separated(int d, double u, double v) const {
    for (const Axis& a : axis_[d]) {
      const double p = a.cu * u + a.cv * v;
      if (p < a.from || p > a.to) return true;
    }
    return false;
  }

  Vec3 lo_, hi_, normal_;
  Axis axis_[3][3];  ///< by coordinate axis, then by edge
  double plane_from_, plane_to_;
};

/// Calls visit(voxel index) for every voxel of the grid that a triangle touches.
template <class Visit>
void for_each_voxel(const Grid& grid, const Vec3& a, const Vec3& b, const Vec3& c, const Visit& visit) {
  TriangleBoxTest(grid.to_grid(a), grid.to_grid(b), grid.to_grid(c)).for_each_box(grid.dims, [&](int i, int j, int k) {
    visit(grid.index(i, j, k));
  });
}
template <class Visit>
void for_each_voxel(const Grid& grid, const Mesh& mesh, int face, const Visit& visit) {
  for_each_voxel(grid, mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2), visit);
}

/// The voxels that the faces with flag 1 touch (no flags: all faces).
VoxelSet rasterize(const Mesh& mesh, const std::vector<char>& flags, const Grid& grid, int threads);

}  // namespace parts::cut
