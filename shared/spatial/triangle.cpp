// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/spatial/triangle.h"

#include <algorithm>
#include <cmath>

namespace parts::spatial {
namespace {

/// Where a triangle is no wider than rounding: the closest point of its three sides.
Vec3 closest_on_sides(const std::array<Vec3, 3>& t, const Vec3& p) {
  Vec3 best = t[0];
  for (int k = 0; k < 3; ++k) {
    const Vec3 side = t[(k + 1) % 3] - t[k];
    const double length = side.squaredNorm();
    const double at = length > 0 ? std::clamp((p - t[k]).dot(side) / length, 0.0, 1.0) : 0;
    const Vec3 q = t[k] + at * side;
    if ((q - p).squaredNorm() < (best - p).squaredNorm()) best = q;
  }
  return best;
}

}  // namespace

Vec3 closest_on_triangle(const std::array<Vec3, 3>& t, const Vec3& p) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0], bp = p - t[1], cp = p - t[2];
  const double lengths = ab.squaredNorm() * ac.squaredNorm();
  if (lengths - std::pow(ab.dot(ac), 2) <= 1e-14 * lengths) return closest_on_sides(t, p);  // else regions are noise
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return t[0];
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return t[1];
  const double c = d1 * d4 - d3 * d2;
  if (c <= 0 && d1 >= 0 && d3 <= 0) return t[0] + d1 / (d1 - d3) * ab;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return t[2];
  const double b = d5 * d2 - d1 * d6;
  if (b <= 0 && d2 >= 0 && d6 <= 0) return t[0] + d2 / (d2 - d6) * ac;
  const double a = d3 * d6 - d5 * d4;
  if (a <= 0 && d4 >= d3 && d5 >= d6) return t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]);
  const double sum = a + b + c;
  return t[0] + b / sum * ab + c / sum * ac;
}

}  // namespace parts::spatial
