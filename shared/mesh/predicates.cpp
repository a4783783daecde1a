// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/predicates.h"

#include <cmath>

namespace parts::mesh {
namespace {

constexpr double kEpsilon = 0x1p-53;

/// A number as an exact sum of doubles that do not overlap, smallest first.
class Expansion {
 public:
  Expansion() = default;
  static Expansion difference(double a, double b) {
    Expansion e;
    e.add(a);
    e.add(-b);
    return e;
  }
  void add(double b) {
    int n = 0;
    for (int i = 0; i < n_; ++i) {
      const double sum = b + c_[i], part = sum - b;
      const double lost = (b - (sum - part)) + (c_[i] - part);
      if (lost != 0) c_[n++] = lost;
      b = sum;
    }
    if (b != 0) c_[n++] = b;
    n_ = n;
  }
  void add(const Expansion& e, double sign) {
    for (int i = 0; i < e.n_; ++i) add(sign * e.c_[i]);
  }
  Expansion operator*(const Expansion& e) const {
    Expansion product;
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < e.n_; ++j) product.add_product(c_[i], e.c_[j]);
    return product;
  }
  int sign() const { return n_ == 0 ? 0 : c_[n_ - 1] > 0 ? 1 : -1; }

 private:
  static void split(double a, double& high, double& low) {
    const double big = 134217729 * a;  // 2^27 + 1
    high = big - (big - a);
    low = a - high;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    double ah, al, bh, bl;
    split(a, ah, al);
    split(b, bh, bl);
    add(al * bl - (((product - ah * bh) - al * bh) - ah * bl));
    add(product);
  }
  double c_[192];  // a 3x3 determinant of two-term differences needs no more
  int n_ = 0;
};

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Expansion m[3][3];
  const Vec3* rows[] = {&a, &b, &c};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) m[i][k] = Expansion::difference((*rows[i])[k], d[k]);
  Expansion det;
  for (int k = 0; k < 3; ++k) {
    const int x = (k + 1) % 3, y = (k + 2) % 3;
    Expansion minor = m[1][x] * m[2][y];
    minor.add(m[1][y] * m[2][x], -1);
    det.add(minor * m[0][k], 1);
  }
  return det.sign();
}

int exact_turn(const Vec3& a, const Vec3& b, const Vec3& c, int x, int y) {
  Expansion det = Expansion::difference(a[x], c[x]) * Expansion::difference(b[y], c[y]);
  det.add(Expansion::difference(a[y], c[y]) * Expansion::difference(b[x], c[x]), -1);
  return det.sign();
}

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = a - d, v = b - d, w = c - d;
  const double vw[3][2] = {
      {v.y() * w.z(), v.z() * w.y()}, {v.z() * w.x(), v.x() * w.z()}, {v.x() * w.y(), v.y() * w.x()}};
  double det = 0, size = 0;
  for (int k = 0; k < 3; ++k) {
    det += u[k] * (vw[k][0] - vw[k][1]);
    size += std::abs(u[k]) * (std::abs(vw[k][0]) + std::abs(vw[k][1]));
  }
  const double bound = (8 + 64 * kEpsilon) * kEpsilon * size;
  if (det > bound) return 1;
  if (det < -bound) return -1;
  return size == 0 ? 0 : exact_orientation(a, b, c, d);
}

int turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  const double left = (a[x] - c[x]) * (b[y] - c[y]), right = (a[y] - c[y]) * (b[x] - c[x]);
  const double bound = (4 + 32 * kEpsilon) * kEpsilon * (std::abs(left) + std::abs(right));
  if (left - right > bound) return 1;
  if (left - right < -bound) return -1;
  return left == 0 && right == 0 ? 0 : exact_turn(a, b, c, x, y);
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  return turn(a, b, c, 0) == 0 && turn(a, b, c, 1) == 0 && turn(a, b, c, 2) == 0;
}

}  // namespace parts::mesh
