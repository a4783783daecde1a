// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/shape_prior.h"

#include <gtest/gtest.h>

namespace parts {
namespace {

/// A strip of points along x, its heights those of a bump of this height and a tilt.
std::vector<Vec3> strip(double bump, double tilt) {
  std::vector<Vec3> points;
  for (int i = 0; i <= 40; ++i) {
    const double x = -1 + i / 20.0;
    points.emplace_back(x, 0, bump * std::exp(-8 * x * x) + tilt * x);
  }
  return points;
}

std::vector<mend::PlaneObservation> ends_of(const std::vector<Vec3>& shape, double noise) {
  std::vector<mend::PlaneObservation> seen;
  for (int v = 0; v < int(shape.size()); ++v)
    if (std::abs(shape[v].x()) > 0.5) seen.push_back({v, shape[v], Vec3::UnitZ(), noise});
  return seen;
}

double worst(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t v = 0; v < a.size(); ++v) most = std::max(most, (a[v] - b[v]).norm());
  return most;
}

TEST(ShapePrior, NothingSeenIsTheMean) {
  const mend::ShapePrior prior({strip(0.1, 0), strip(0.3, 0)}, {0.25, 0.75}, 1);
  EXPECT_LT(worst(prior.given({}), strip(0.25, 0)), 1e-12);
}

TEST(ShapePrior, WhatGoesTogetherInTheShapesIsFollowed) {
  // The higher the bump, the steeper the tilt: the ends tell the bump's height.
  const mend::ShapePrior prior({strip(2, 1), strip(6, 3), strip(4, 2)}, {0.3, 0.3, 0.4}, 1);
  const std::vector<Vec3> truth = strip(5, 2.5);
  const std::vector<mend::PlaneObservation> seen = ends_of(truth, 1e-4);
  EXPECT_LT(worst(prior.given(seen), truth), 0.1 * worst(prior.mean(), truth));
}

TEST(ShapePrior, WhatNoBlendExplainsIsMetWhereItIsSeen) {
  const mend::ShapePrior prior({strip(0.2, 0), strip(0.3, 0)}, {0.5, 0.5}, 1);
  std::vector<Vec3> truth = strip(0.25, 0);
  for (Vec3& p : truth) p.z() += 0.1 * p.x() * p.x();
  const std::vector<Vec3> shape = prior.given(ends_of(truth, 1e-4));
  for (const mend::PlaneObservation& s : ends_of(truth, 0)) EXPECT_NEAR(shape[s.vertex].z(), truth[s.vertex].z(), 1e-3);
}

TEST(ShapePrior, NoisyPointsAreAveraged) {
  const mend::ShapePrior prior({strip(0.2, 0), strip(0.3, 0)}, {0.5, 0.5}, 1);
  std::vector<mend::PlaneObservation> seen = ends_of(strip(0.25, 0), 0.5);
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i].point.z() += i % 2 ? 0.1 : -0.1;
  EXPECT_LT(worst(prior.given(seen), strip(0.25, 0)), 0.02);
}

TEST(ShapePrior, OnlyTheNormalCounts) {
  const mend::ShapePrior prior({strip(0.2, 0), strip(0.3, 0)}, {0.5, 0.5}, 1);
  std::vector<mend::PlaneObservation> seen = ends_of(strip(0.25, 0), 1e-3);
  for (mend::PlaneObservation& s : seen) s.point += Vec3(0.3, -0.7, 0);
  EXPECT_LT(worst(prior.given(seen), prior.mean()), 1e-9);
}

}  // namespace
}  // namespace parts
