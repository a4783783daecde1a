// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/align/comparison.h"

#include <algorithm>
#include <cmath>

#include "parts/base/parallel.h"

namespace parts::align {
namespace {

constexpr int kGridSamples = 6000, kGridCells = 48;

/// The pose of the fixed surface in the moving one's frame. For a mirrored pose
/// of the fixed surface mirrored: mirroring it instead leaves a rotation.
Pose inverse(const Pose& pose) {
  Pose p;
  p.mirrored = pose.mirrored;
  p.rotation = pose.rotation.transpose();
  p.scale = 1 / pose.scale;
  p.translation = -p.scale * (p.rotation * pose.translation);
  if (pose.mirrored) {
    p.rotation.row(0) *= -1, p.rotation.col(0) *= -1;
    p.translation[0] *= -1;
  }
  return p;
}

}  // namespace

Comparison::Comparison(const spatial::Surface& moving, const spatial::Surface& fixed, double overlap)
    : moving_(moving), fixed_(fixed), overlap_(overlap), moving_tree_(moving), fixed_tree_(fixed) {
  moving_samples_[0] = moving_samples_[1] = spatial::sample_surface(moving, kSamples);
  fixed_samples_[0] = fixed_samples_[1] = spatial::sample_surface(fixed, kSamples);
  for (std::vector<spatial::Sample>* mirrored : {&moving_samples_[1], &fixed_samples_[1]})
    for (spatial::Sample& s : *mirrored) s.point[0] *= -1, s.normal[0] *= -1;
}

void Comparison::prepare_grids() {
  moving_grid_ =
      std::make_unique<spatial::ClosestSampleGrid>(spatial::sample_surface(moving_, kGridSamples), kGridCells);
  fixed_grid_ = std::make_unique<spatial::ClosestSampleGrid>(spatial::sample_surface(fixed_, kGridSamples), kGridCells);
}

const spatial::ClosestPoint& Comparison::moving_target(bool exact) const {
  return exact ? static_cast<const spatial::ClosestPoint&>(moving_tree_) : *moving_grid_;
}
const spatial::ClosestPoint& Comparison::fixed_target(bool exact) const {
  return exact ? static_cast<const spatial::ClosestPoint&>(fixed_tree_) : *fixed_grid_;
}

double Comparison::score(const Pose& pose, const Detail& detail) const {
  const double forth =
      PoseScore(moving_samples_[pose.mirrored], detail.samples, overlap_, fixed_target(detail.exact))(pose);
  const double covered = overlap_ * moving_.area() * pose.scale * pose.scale / fixed_.area();
  const double back = PoseScore(fixed_samples_[pose.mirrored], detail.samples, std::min(1.0, covered),
                                moving_target(detail.exact))(inverse(pose));
  return std::hypot(forth, back / pose.scale);
}

IcpResult Comparison::refine(const Pose& start, const Detail& detail, const IcpOptions& options,
                             const std::function<void()>& poll) const {
  const std::vector<spatial::Sample>& moving = moving_samples_[start.mirrored];
  const spatial::ClosestPoint& fixed = fixed_target(detail.exact);
  IcpResult result = icp(moving, fixed, start, options, poll);
  result.score = score(result.pose, detail);
  if (detail.other_sizes && !options.scale) {
    // Shapes of one kind but of two sizes, such as heads of two people, touch
    // in many ways at the sizes that they have; shape tells the right one.
    IcpOptions free = options;
    free.scale = true;
    free.iterations = std::min(10, options.iterations);
    free.samples = std::min(600, options.samples);
    Detail coarser = detail;
    coarser.samples = free.samples;
    result.score = std::sqrt(result.score * score(icp(moving, fixed, result.pose, free, poll).pose, coarser));
  }
  return result;
}

std::vector<double> Comparison::distances(const Pose& pose, int threads) const {
  const std::vector<spatial::Sample>& samples = moving_samples_[pose.mirrored];
  std::vector<double> d(samples.size());
  parallel_for(long(d.size()), threads, [&](long begin, long end) {
    int hint = 0;
    for (long i = begin; i < end; ++i) {
      const Vec3 p = pose(samples[i].point);
      d[i] = (fixed_tree_.closest(p, hint).point - p).norm();
    }
  });
  std::sort(d.begin(), d.end());
  return d;
}

double Comparison::share_within(double distance, const Pose& pose, int threads) const {
  const std::vector<spatial::Sample>& samples = moving_samples_[pose.mirrored];
  std::vector<char> lies_on(samples.size(), 0);
  parallel_for(long(samples.size()), threads, [&](long begin, long end) {
    int hint = 0;
    for (long i = begin; i < end; ++i) {
      const Vec3 p = pose(samples[i].point);
      const spatial::Closest c = fixed_tree_.closest(p, hint);
      lies_on[i] =
          (c.point - p).norm() <= distance && std::abs(c.normal.dot(pose.rotation * samples[i].normal)) > M_SQRT1_2;
    }
  });
  return double(std::count(lies_on.begin(), lies_on.end(), 1)) / double(samples.size());
}

}  // namespace parts::align
