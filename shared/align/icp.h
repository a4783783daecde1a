// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "parts/align/pose.h"
#include "parts/spatial/closest_point.h"

namespace parts::align {

struct IcpOptions {
  int samples = 1000;     ///< the first so many of the moving samples
  int iterations = 50;    ///< at most
  double overlap = 1;     ///< share of the samples that is matched, the closest ones
  bool scale = false;     ///< find a uniform scale too
  double sliding = 0.05;  ///< weight of the distance along the surface against that across it
  double done = 1e-7;     ///< step at which it has converged, in the fixed surface's unit
};

struct IcpResult {
  Pose pose;
  double score = 0;  ///< trimmed residual with a penalty for turned-away normals, in the moving surface's unit
  int iterations = 0;
};

/// How well a pose fits, without moving it: the score of IcpResult.
class PoseScore {
 public:
  PoseScore(const std::vector<spatial::Sample>& moving, int samples, double overlap,
            const spatial::ClosestPoint& fixed);
  double operator()(const Pose& pose);

 private:
  friend class IcpLoop;
  struct Pair {
    Vec3 moved;  ///< the sample, moved
    spatial::Closest fixed;
    double agreement;  ///< cosine between the normals, whatever their signs
    double cost;       ///< squared distance and penalty
  };
  void match(const Pose& pose);

  const std::vector<spatial::Sample>& moving_;
  const spatial::ClosestPoint& fixed_;
  std::vector<Pair> pairs_;
  std::vector<int> hints_;
  std::vector<int> order_;  ///< the kept pairs come first
  int kept_;
};

/// Trimmed iterative closest point (Chetverikov et al., 2005) with the
/// point-to-plane metric (Chen and Medioni, 1992), a little point-to-point
/// distance that keeps planes, spheres and the like from sliding, and normals
/// that must agree. Never returns a pose that fits worse than the start.
/// @param poll  called at each iteration; may throw to stop
IcpResult icp(const std::vector<spatial::Sample>& moving, const spatial::ClosestPoint& fixed, const Pose& start,
              const IcpOptions& options, const std::function<void()>& poll);

}  // namespace parts::align
