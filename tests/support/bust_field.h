// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "support/busts.h"

namespace parts::test {

inline double ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii) {
  const Vec3 q = (p - center).cwiseQuotient(radii);
  const double k0 = q.norm(), k1 = q.cwiseQuotient(radii).norm();
  return k1 > 0 ? k0 * (k0 - 1) / k1 : -radii.minCoeff();
}
inline double ball(const Vec3& p, const Vec3& center, double radius) { return (p - center).norm() - radius; }
inline double cone(const Vec3& p, const Vec3& a, double ra, const Vec3& b, double rb) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm() - (ra + t * (rb - ra));
}
inline double melt(double a, double b, double k) {  // union with a fillet of size k
  const double h = std::max(0.0, k - std::abs(a - b)) / k;
  return std::min(a, b) - h * h * k / 4;
}
inline double carve(double a, double b, double k) { return -melt(-a, b, k); }  // a without b

/// The bust's surface is where this is 0.
class BustField {
 public:
  static constexpr double kBase = -1.12;  ///< where the bust is cut off

  explicit BustField(const BustShape& shape) : b_(shape), face_(0.87 * b_.head_length) {
    for (double z = 0.7; z > 0 && skull({0, b_.mouth_height, z}) > 0; z -= 0.002) mouth_ = z;
  }

  double operator()(const Vec3& p) const {
    const Vec3 q(std::abs(p.x()), p.y(), p.z());  // both sides are alike
    double d = skull(q);
    d = eyes(q, d);
    d = mouth(q, d);
    d = nose(q, d);
    d = ears(q, d);
    return body(q, d);
  }

  Vec3 eye() const { return {b_.eye_distance, 0.035, face_ - 0.035 - b_.eye_depth}; }
  Vec3 nose_end() const { return {0, 0.06 - b_.nose_length - b_.nose_tip_drop, face_ + b_.nose_forward - b_.nose_tip}; }
  double chin_y() const { return -b_.jaw_drop - 0.2; }
  /// Where a ray from inside meets the surface.
  Vec3 hit(Vec3 from, const Vec3& direction) const {
    double low = 0, high = 2;
    for (int i = 0; i < 200 && (*this)(from + i * 0.01 * direction) < 0; ++i) low = i * 0.01, high = low + 0.01;
    for (int i = 0; i < 50; ++i) {
      const double mid = (low + high) / 2;
      ((*this)(from + mid * direction) < 0 ? low : high) = mid;
    }
    return from + low * direction;
  }

 private:
  double skull(const Vec3& q) const {
    double d = ellipsoid(q, {0, 0.1, -0.05}, {b_.head_width, b_.head_height, b_.head_length});
    d = melt(d, ellipsoid(q, {0, -b_.jaw_drop, 0.1}, {b_.jaw_width, 0.27, 0.27}), 0.14);
    d = melt(d, ball(q, {0, chin_y(), b_.chin_forward - 0.02}, b_.chin), 0.1);
    d = melt(d, ball(q, {0.19, b_.cheek_height, face_ - 0.14}, b_.cheek), 0.12);
    d = melt(d,
             cone(q, {0, b_.brow_height, face_ - 0.01}, b_.brow, {0.22, b_.brow_height - 0.01, face_ - 0.14}, b_.brow),
             0.08);
    return d;
  }
  double eyes(const Vec3& q, double d) const {
    const Vec3 e = eye();
    d = carve(d, ellipsoid(q, {e.x() + 0.005, e.y() - 0.005, face_ - 0.01}, {0.1, 0.062, b_.eye_depth + 0.02}), 0.07);
    return melt(d, ball(q, e, b_.eye_size), 0.02);
  }
  double nose(const Vec3& q, double d) const {
    const Vec3 tip = nose_end();
    const double wing_y = 0.06 - b_.nose_length;
    double n = cone(q, {0, 0.09, face_ - 0.02}, b_.nose_bridge, tip, b_.nose_tip);
    n = melt(n, ball(q, {0.8 * b_.nose_width, wing_y, face_ + 0.03}, 0.5 * b_.nose_tip + 0.014), 0.07);
    n = carve(n, ellipsoid(q, {0.45 * b_.nose_width, wing_y - 0.04, face_ + 0.05}, {0.016, 0.02, 0.028}), 0.02);
    return melt(d, n, 0.06);
  }
  double mouth(const Vec3& q, double d) const {
    const double z = mouth_ + 0.012, y = b_.mouth_height, arch = 0.35 * q.x() * q.x() / b_.mouth_width;
    d = melt(d, ellipsoid(q, {0, y, z - 0.095}, {1.3 * b_.mouth_width, 0.1, 0.1}), 0.06);
    const Vec3 r(q.x(), q.y() - arch, q.z() + 0.9 * q.x() * q.x());
    const double upper = ellipsoid(r, {0, y + 0.75 * b_.lip, z}, {b_.mouth_width, b_.lip, 1.1 * b_.lip});
    const double lower =
        ellipsoid(r, {0, y - 0.85 * b_.lip, z - 0.004}, {0.85 * b_.mouth_width, 1.1 * b_.lip, 1.2 * b_.lip});
    return melt(d, std::min(upper, lower), 0.016);
  }
  double ears(const Vec3& q, double d) const {
    const double c = std::cos(b_.ear_out), s = std::sin(b_.ear_out);
    const Vec3 o(b_.head_width - 0.005, 0.0, -0.06);
    const Vec3 p = q - o;  // turned about y so that the back of the ear stands off
    const Vec3 r(c * p.x() + s * p.z(), p.y() + 0.15 * p.z(), -s * p.x() + c * p.z());
    double ear = ellipsoid(r, {0.01, 0, -0.02}, {0.036, b_.ear_size, 0.62 * b_.ear_size});
    ear = carve(ear, ellipsoid(r, {0.055, 0.012, -0.015}, {0.035, 0.66 * b_.ear_size, 0.4 * b_.ear_size}), 0.02);
    return melt(d, ear, 0.03);
  }
  double body(const Vec3& q, double d) const {
    const double top = -0.82 - b_.shoulder_drop;
    double t = cone(q, {0, -0.2, -0.1}, b_.neck, {0, -0.8, -0.15}, 1.15 * b_.neck);
    t = melt(t, cone(q, {0, top + 0.06, -0.15}, 0.2, {b_.shoulder_width, top - 0.02, -0.17}, 0.16), 0.2);
    t = melt(t, ellipsoid(q, {0, -1.12, -0.1}, {b_.shoulder_width + 0.06, 0.36, 0.27}), 0.12);
    t = melt(t, ellipsoid(q, {0, chin_y() + 0.0, 0.02}, {0.05, 0.12, 0.08}), 0.1);
    d = melt(d, t, 0.07);
    return carve(d, q.y() - kBase, 0.1);
  }

  const BustShape& b_;
  double face_;       // z of the face's plane
  double mouth_ = 0;  // z of the skull there
};

}  // namespace parts::test
