// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/align/icp.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

namespace parts::align {
namespace {

using Matrix7 = Eigen::Matrix<double, 7, 7>;
using Vector7 = Eigen::Matrix<double, 7, 1>;

// Turned-away normals cost as much as this distance, in RMS radii of the moved part.
constexpr double kNormalPenalty = 0.1;
// How far the scale may leave its start.
constexpr double kScaleRange = 2.5;

Eigen::Matrix3d rotation_of(const Vec3& v) {
  const double angle = v.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, v / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

}  // namespace

PoseScore::PoseScore(const std::vector<spatial::Sample>& moving, int samples, double overlap,
                     const spatial::ClosestPoint& fixed)
    : moving_(moving), fixed_(fixed) {
  const int n = std::min(samples, int(moving.size()));
  pairs_.resize(n);
  hints_.assign(n, 0);
  order_.resize(n);
  kept_ = std::clamp(int(std::ceil(overlap * n)), 1, n);
}

void PoseScore::match(const Pose& pose) {
  const Eigen::Matrix3d linear = pose.scale * pose.rotation;
  const double penalty = kNormalPenalty * kNormalPenalty * pose.scale * pose.scale;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    Pair& p = pairs_[i];
    p.moved = linear * moving_[i].point + pose.translation;
    p.fixed = fixed_.closest(p.moved, hints_[i]);
    p.agreement = std::min(1.0, std::abs(p.fixed.normal.dot(pose.rotation * moving_[i].normal)));
    p.cost = (p.moved - p.fixed.point).squaredNorm() + penalty * (1 - p.agreement);
  }
  std::iota(order_.begin(), order_.end(), 0);
  if (kept_ < int(order_.size()))
    std::nth_element(order_.begin(), order_.begin() + kept_, order_.end(), [&](int a, int b) {
      return pairs_[a].cost != pairs_[b].cost ? pairs_[a].cost < pairs_[b].cost : a < b;
    });
}

double PoseScore::operator()(const Pose& pose) {
  match(pose);
  double sum = 0;
  for (int i = 0; i < kept_; ++i) sum += pairs_[order_[i]].cost;
  return std::sqrt(sum / kept_) / pose.scale;
}

class IcpLoop {
 public:
  IcpLoop(PoseScore& score, const IcpOptions& options, double start_scale)
      : score_(score), options_(options), start_scale_(start_scale) {}

  /// Moves the pose by the step that the pairs of the last score ask for;
  /// returns how far, in the fixed surface's unit.
  double step(Pose& pose) const {
    const Vec3 center = kept_center();
    Vector7 x = solve(center);
    const double turn = x.head<3>().norm();
    if (turn > 0.5) x.head<3>() *= 0.5 / turn;
    const double low = start_scale_ / kScaleRange / pose.scale, high = start_scale_ * kScaleRange / pose.scale;
    const double growth = options_.scale ? std::clamp(std::exp(std::clamp(x[6], -0.2, 0.2)), low, high) : 1;
    const Eigen::Matrix3d r = rotation_of(x.head<3>());
    pose.translation = center + x.segment<3>(3) + growth * (r * (pose.translation - center));
    pose.rotation = Eigen::Quaterniond(r * pose.rotation).normalized().toRotationMatrix();
    pose.scale *= growth;
    return (turn + std::abs(growth - 1)) * pose.scale + x.segment<3>(3).norm();
  }

 private:
  template <class Visit>
  void each_kept(const Visit& visit) const {
    for (int i = 0; i < score_.kept_; ++i) visit(score_.pairs_[score_.order_[i]]);
  }
  Vec3 kept_center() const {
    Vec3 sum = Vec3::Zero();
    each_kept([&](const PoseScore::Pair& p) { sum += p.moved; });
    return sum / score_.kept_;
  }

  /// Least squares for (rotation, translation, log scale) about center. The
  /// residual is taken in the moving surface's unit, e / scale, or shrinking
  /// would always pay: hence x - residual, not x, in the scale's column.
  Vector7 solve(const Vec3& center) const {
    Matrix7 a = Matrix7::Zero();
    Vector7 b = Vector7::Zero();
    each_kept([&](const PoseScore::Pair& p) {
      const double weight = std::max(0.05, p.agreement);
      const Vec3 e = p.moved - p.fixed.point, arm = p.moved - center, n = p.fixed.normal;
      Vector7 row;
      row << arm.cross(n), n, n.dot(arm - e);
      a.noalias() += weight * row * row.transpose();
      b -= weight * n.dot(e) * row;
      Eigen::Matrix<double, 7, 3> rows;
      rows << cross_matrix(arm), Eigen::Matrix3d::Identity(), (arm - e).transpose();
      a.noalias() += weight * options_.sliding * rows * rows.transpose();
      b -= weight * options_.sliding * (rows * e);
    });
    if (!options_.scale) {
      a.row(6).setZero(), a.col(6).setZero();
      b[6] = 0, a(6, 6) = 1;
    }
    a.diagonal().array() += 1e-12 * a.trace();
    return a.ldlt().solve(b);
  }
  static Eigen::Matrix3d cross_matrix(const Vec3& v) {
    Eigen::Matrix3d m;
    m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
    return m;
  }

  PoseScore& score_;
  const IcpOptions& options_;
  double start_scale_;
};

IcpResult icp(const std::vector<spatial::Sample>& moving, const spatial::ClosestPoint& fixed, const Pose& start,
              const IcpOptions& options, const std::function<void()>& poll) {
  PoseScore score(moving, options.samples, options.overlap, fixed);
  const IcpLoop loop(score, options, start.scale);
  Pose pose = start;
  IcpResult best{pose, score(pose), 0};
  double milestone = best.score;
  for (int i = 1, stalled = 0; i <= options.iterations; ++i) {
    poll();
    const double moved = loop.step(pose);
    const double s = score(pose);
    if (s < best.score) best = {pose, s, best.iterations};
    best.iterations = i;
    if (moved < options.done) break;
    // Creeping: three steps that together gained less than a thousandth.
    if (best.score < milestone * 0.999)
      milestone = best.score, stalled = 0;
    else if (++stalled == 4)
      break;
  }
  return best;
}

}  // namespace parts::align
