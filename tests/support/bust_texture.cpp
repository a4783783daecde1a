// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "support/bust_field.h"
#include "support/busts.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

/// The colour of a point of the bust.
class Paint {
 public:
  Paint(const BustShape& shape) : b_(shape), field_(shape) {
    Random random(shape.seed * 7919 + 17);
    for (auto& w : waves_) {
      for (int d = 0; d < 3; ++d) w[d] = random.uniform(-1, 1);
      w.head<3>() = w.head<3>().normalized() * random.uniform(12, 45);
      w[3] = random.uniform(0, 6.28);
    }
  }

  Eigen::Vector3d operator()(const Vec3& p) const {
    if (p.y() < shirt_line(p)) return b_.shirt * (1 + 0.04 * grain(2 * p));
    const Vec3 q(std::abs(p.x()), p.y(), p.z());
    const double hair = hair_line(q);
    Eigen::Vector3d c = b_.skin * (1 + 0.02 * grain(p));
    const Eigen::Vector3d blush = c.cwiseProduct(Eigen::Vector3d(1.0, 0.86, 0.84));
    const auto near = [&](double x, double y, double r) {
      return q.z() > 0.1 ? std::exp(-(Eigen::Vector2d(q.x() - x, q.y() - y) / r).squaredNorm()) : 0.0;
    };
    c = mix(c, blush, 0.9 * near(0.19, -0.1, 0.09) + 0.8 * near(0, field_.nose_end().y(), 0.06));
    c = mix(c, c * 0.78, 0.7 * near(b_.eye_distance, 0.045, 0.085));
    c = mix(c, b_.hair, 0.9 * brow(q));
    c = lips(q, c);
    c = eye(q, c);
    return mix(c, b_.hair * (1 + 0.18 * grain({2.5 * p.x(), 0.6 * p.y(), 2.5 * p.z()})), smooth(hair / 0.02 + 0.5));
  }

 private:
  static Eigen::Vector3d mix(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double t) {
    return a + std::clamp(t, 0.0, 1.0) * (b - a);
  }
  static double smooth(double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
  }
  double grain(const Vec3& p) const {
    double sum = 0;
    for (const auto& w : waves_) sum += std::sin(w.head<3>().dot(p) + w[3]);
    return sum / 3;
  }
  double shirt_line(const Vec3& p) const { return -0.72 - 0.9 * std::max(0.0, p.z() + 0.1); }
  /// How far inside the hair, about.
  double hair_line(const Vec3& q) const {
    const double front = q.y() - (b_.brow_height + b_.hair_line - 0.9 * q.x() * q.x());
    const double sides = 0.03 - q.z() + 0.5 * (q.y() - 0.05), nape = q.y() + 0.28;
    const double ear = (q - Vec3(b_.head_width + 0.02, 0, -0.08)).norm() - 1.05 * b_.ear_size;
    return std::max(front, std::min({sides, nape, ear}));
  }
  double brow(const Vec3& q) const {
    if (q.z() < 0.1) return 0;
    const double y = b_.brow_height - 0.015 - 1.2 * std::pow(q.x() - 0.14, 2);
    return smooth((0.021 - std::abs(q.y() - y)) / 0.01) * smooth((q.x() - 0.045) / 0.02) *
           smooth((0.25 - q.x()) / 0.03);
  }
  Eigen::Vector3d lips(const Vec3& q, const Eigen::Vector3d& c) const {
    if (q.z() < 0.2 || q.x() > b_.mouth_width) return c;
    const double x = q.x() / b_.mouth_width, y = q.y() - b_.mouth_height - 0.35 * q.x() * q.x() / b_.mouth_width;
    const double high = 1.55 * b_.lip * (1 - x * x), low = -1.75 * b_.lip * (1 - x * x);
    const double inside = std::min(high - y, y - low);
    const Eigen::Vector3d lip = mix(b_.lips, b_.lips * 0.5, std::exp(-std::pow(y / 0.005, 2)));
    return mix(c, lip, smooth(inside / 0.008 + 0.5));
  }
  Eigen::Vector3d eye(const Vec3& q, const Eigen::Vector3d& c) const {
    const Vec3 e = field_.eye();
    const double x = (q.x() - e.x()) / (0.82 * b_.eye_size), y = q.y() - e.y();
    if (std::abs(x) > 1 || q.z() < e.z()) return c;
    const double open = 0.42 * b_.eye_size * (1 - x * x);
    const double inside = std::min(1.1 * open - y, y + 0.8 * open), r = std::hypot(q.x() - e.x(), y) / b_.eye_size;
    Eigen::Vector3d ball(236, 232, 228);
    ball = mix(ball, b_.iris, smooth((0.36 - r) / 0.05));
    ball = mix(ball, Eigen::Vector3d(18, 16, 16), smooth((0.17 - r) / 0.05));
    const Eigen::Vector3d lashes = mix(c, b_.hair * 0.6, smooth(inside / 0.008 + 1.2));
    return mix(lashes, ball, smooth(inside / 0.006));
  }

  const BustShape& b_;
  BustField field_;
  std::array<Eigen::Vector4d, 9> waves_;
};

/// Visits the pixels of a face in the texture with their barycentric
/// coordinates; those just outside too, so that filters find colour.
template <class Visit>
void for_each_texel(const Wedges& w, int size, const Visit& visit) {
  std::array<Eigen::Vector2d, 3> t;
  Eigen::AlignedBox2d box;
  for (int k = 0; k < 3; ++k) {
    t[k] = Eigen::Vector2d(w.uv[k].x() * size - 0.5, (1 - w.uv[k].y()) * size - 0.5);
    box.extend(t[k]);
  }
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); };
  const double area = cross(t[1] - t[0], t[2] - t[0]);
  if (area == 0) return;
  const double slack = 1.5 * std::sqrt(box.sizes().squaredNorm()) / std::abs(area);
  for (int y = std::max(0, int(box.min().y()) - 1); y <= std::min(size - 1, int(box.max().y()) + 2); ++y)
    for (int x = std::max(0, int(box.min().x()) - 1); x <= std::min(size - 1, int(box.max().x()) + 2); ++x) {
      const Eigen::Vector2d p(x, y);
      Vec3 b(cross(t[1] - p, t[2] - p) / area, cross(t[2] - p, t[0] - p) / area, 0);
      b[2] = 1 - b[0] - b[1];
      if (b.minCoeff() >= -std::min(slack, 1.0)) visit(y, x, b);
    }
}

}  // namespace

cv::Mat bust_texture(const BustShape& shape, const Mesh& mesh, int size) {
  const Paint paint(shape);
  cv::Mat image(size, size, CV_8UC3, cv::Scalar(shape.skin[2], shape.skin[1], shape.skin[0]));
  cv::Mat depth(size, size, CV_32F, cv::Scalar(1e9f));  // how far outside the face that painted a pixel it lies
  for (int f = 0; f < mesh.face_count(); ++f)
    for_each_texel(mesh.wedges[f], size, [&](int y, int x, const Vec3& b) {
      const float outside = float(std::max(0.0, -b.minCoeff()));
      if (outside >= depth.at<float>(y, x)) return;
      depth.at<float>(y, x) = outside;
      const Vec3 inside = (b.cwiseMax(0.0)) / b.cwiseMax(0.0).sum();
      const Eigen::Vector3d c =
          paint(inside[0] * mesh.corner(f, 0) + inside[1] * mesh.corner(f, 1) + inside[2] * mesh.corner(f, 2));
      for (int k = 0; k < 3; ++k)
        image.at<cv::Vec3b>(y, x)[2 - k] = std::uint8_t(std::lround(std::clamp(c[k], 0.0, 255.0)));
    });
  return image;
}

}  // namespace parts::test
