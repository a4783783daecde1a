// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/align/coarse_poses.h"

#include <algorithm>
#include <numeric>

namespace parts::align {
namespace {

constexpr int kSpreadRotations = 192;  // about 30 degrees from any rotation to the next of them
constexpr double kWhole = 0.85;        // a share above it counts as the whole

/// A whole surface or a piece of it, to be laid on one of the other.
struct Anchor {
  Vec3 center = Vec3::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
};

/// The share of the samples closest to seed.
Anchor piece_around(const Vec3& seed, const std::vector<spatial::Sample>& samples, double share) {
  std::vector<std::pair<double, int>> near(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) near[i] = {(samples[i].point - seed).squaredNorm(), int(i)};
  const int n = std::clamp(int(share * double(samples.size())), 8, int(samples.size()));
  std::nth_element(near.begin(), near.begin() + (n - 1), near.end());
  Vec3 mean = Vec3::Zero();
  for (int i = 0; i < n; ++i) mean += samples[near[i].second].point;
  mean /= n;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int i = 0; i < n; ++i) {
    const Vec3 d = samples[near[i].second].point - mean;
    covariance += d * d.transpose();
  }
  return {mean, spatial::principal_axes(covariance)};
}

/// Pieces of the given share, grown around seeds far from each other; enough to overlap well.
std::vector<Anchor> pieces(const std::vector<spatial::Sample>& samples, double share) {
  std::vector<Anchor> found;
  std::vector<double> distance(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) distance[i] = samples[i].point.squaredNorm();
  const int count = std::clamp(int(std::ceil(6 / share)), 8, 48);
  for (int k = 0; k < count; ++k) {
    const Vec3 seed = samples[std::max_element(distance.begin(), distance.end()) - distance.begin()].point;
    for (std::size_t i = 0; i < samples.size(); ++i)
      distance[i] = k == 0 ? (samples[i].point - seed).squaredNorm()
                           : std::min(distance[i], (samples[i].point - seed).squaredNorm());
    found.push_back(piece_around(seed, samples, share));
  }
  return found;
}

/// The middle of the box along the principal axes.
Vec3 box_center(const std::vector<spatial::Sample>& samples, const Eigen::Matrix3d& axes) {
  Box box;
  for (const spatial::Sample& s : samples) box.extend(axes.transpose() * s.point);
  return axes * box.center();
}

}  // namespace

std::vector<Eigen::Matrix3d> spread_rotations(int count) {
  const double phi = std::sqrt(2.0), psi = 1.533751168755204288118041;
  std::vector<Eigen::Matrix3d> rotations;
  for (int i = 0; i < count; ++i) {
    const double s = i + 0.5, r = std::sqrt(s / count), q = std::sqrt(1 - s / count);
    const double a = 2 * M_PI * s / phi, b = 2 * M_PI * s / psi;
    rotations.push_back(
        Eigen::Quaterniond(q * std::cos(b), r * std::sin(a), r * std::cos(a), q * std::sin(b)).toRotationMatrix());
  }
  return rotations;
}

std::vector<Eigen::Matrix3d> axis_rotations() {
  std::vector<Eigen::Matrix3d> rotations;
  for (int first = 0; first < 6; ++first)
    for (int second = 0; second < 6; ++second) {
      if (first / 2 == second / 2) continue;
      Eigen::Matrix3d r;
      r.col(0) = (first % 2 ? -1 : 1) * Vec3::Unit(first / 2);
      r.col(1) = (second % 2 ? -1 : 1) * Vec3::Unit(second / 2);
      r.col(2) = r.col(0).cross(r.col(1));
      rotations.push_back(r);
    }
  return rotations;
}

std::vector<CoarsePose> coarse_poses(const CoarseSurface& moving, const CoarseSurface& fixed, double scale,
                                     double overlap) {
  static const std::vector<Eigen::Matrix3d> axis = axis_rotations(), spread = spread_rotations(kSpreadRotations);
  std::vector<CoarsePose> poses;
  const auto lay = [&](const Anchor& m, const Anchor& f, bool thesis) {
    const auto add = [&](const Eigen::Matrix3d& between, bool t) {
      Pose p;
      p.rotation = f.axes * between * m.axes.transpose();
      p.scale = scale;
      p.translation = f.center - scale * (p.rotation * m.center);
      poses.push_back({p, t});
    };
    for (const Eigen::Matrix3d& r : axis) add(r, thesis);
    for (const Eigen::Matrix3d& r : spread) add(r, false);
  };

  const Anchor whole_moving{Vec3::Zero(), spatial::principal_axes(moving.covariance)};
  const Anchor whole_fixed{Vec3::Zero(), spatial::principal_axes(fixed.covariance)};
  lay(whole_moving, whole_fixed, true);
  lay({box_center(moving.samples, whole_moving.axes), whole_moving.axes},
      {box_center(fixed.samples, whole_fixed.axes), whole_fixed.axes}, false);

  // The share of each surface that can match the other one.
  const double area_ratio = moving.area * scale * scale / fixed.area;
  const double moving_share = std::min(overlap, 1 / area_ratio), fixed_share = std::min(1.0, overlap * area_ratio);
  const auto anchors = [](const CoarseSurface& s, const Anchor& whole, double share) {
    return share > kWhole ? std::vector<Anchor>{whole} : pieces(s.samples, share);
  };
  if (moving_share <= kWhole || fixed_share <= kWhole)
    for (const Anchor& m : anchors(moving, whole_moving, moving_share))
      for (const Anchor& f : anchors(fixed, whole_fixed, fixed_share)) lay(m, f, false);
  return poses;
}

}  // namespace parts::align
