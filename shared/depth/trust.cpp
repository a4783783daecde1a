// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/depth/trust.h"

#include <algorithm>
#include <cmath>

#include "parts/depth/small_level.h"
#include "parts/render/mask.h"

namespace parts::depth {
namespace {

// Calibrated on every fourth and fifth head, hand and body (bench_trust).
constexpr double most_strangeness = 1.2, least_overlap = 0.8, least_margin = 1.25;
constexpr double most_difference = 0.12;  // where views are stored and no margin is to be had

using Images = std::vector<synthesis::PatchImage>;

/// {intensity, depth} of some of the objects in use, each once.
struct Members {
  Images images;
  std::vector<int> objects;
  std::vector<render::View> views;
};

Members members_of(const ExampleSet& set) {
  constexpr size_t most = 12;
  Members m;
  for (size_t k = 0; k < set.size() && m.images.size() < most; ++k) {
    if (std::count(m.objects.begin(), m.objects.end(), set[k].object)) continue;
    synthesis::PatchImage e = set.gallery().small(set[k].object, set[k].view);
    e.planes.resize(2);
    m.images.push_back(std::move(e));
    m.objects.push_back(set[k].object);
    m.views.push_back(set[k].view);
  }
  return m;
}

synthesis::PatchImage intensity_of(const synthesis::PatchImage& image) {
  return {{image.planes[0], cv::Mat()}, image.mask};
}

double mean_distance(const synthesis::PatchImage& query, const Images& examples, const DepthOptions& options) {
  return small_distance(intensity_of(query), examples, synthesis_options(options));
}

double strangeness(const synthesis::PatchImage& query, const Images& members, const DepthOptions& options) {
  if (members.size() < 3) return 1;  // nothing to compare with
  double strangest = 0;
  const int asked = std::min(6, int(members.size()));
  for (int i = 0; i < asked; ++i) {
    const size_t k = i * members.size() / asked;
    Images rest = members;
    rest.erase(rest.begin() + long(k));
    strangest = std::max(strangest, mean_distance(members[k], rest, options));
  }
  return strangest > 0 ? mean_distance(query, members, options) / strangest : 1;
}

double overlap(const cv::Mat& a, const cv::Mat& b) {
  const cv::Point2d shift = render::centroid(a) - render::centroid(b);
  const int dx = int(std::lround(shift.x)), dy = int(std::lround(shift.y));
  int both = 0, of_b = cv::countNonZero(b);
  for (int y = 0; y < a.rows; ++y)
    for (int x = 0; x < a.cols; ++x) {
      const int u = x - dx, v = y - dy;
      both += a.at<uchar>(y, x) && u >= 0 && v >= 0 && u < b.cols && v < b.rows && b.at<uchar>(v, u);
    }
  return double(both) / std::max(1, cv::countNonZero(a) + of_b - both);
}

double difference_of_halves(const synthesis::PatchImage& query, const Images& members, const DepthOptions& options) {
  if (members.size() < 4) return 0;
  cv::Mat depth[2];
  for (int half : {0, 1}) {
    Images some;
    for (size_t k = size_t(half); k < members.size(); k += 2) some.push_back(members[k]);
    depth[half] =
        synthesize_small(intensity_of(query), some, synthesis_options(options), std::min(3, options.max_iterations))
            .planes[0];
  }
  double low, high;
  cv::Scalar mean, deviation;
  cv::minMaxLoc(cv::Mat(0.5 * (depth[0] + depth[1])), &low, &high, nullptr, nullptr, query.mask);
  cv::meanStdDev(depth[0] - depth[1], mean, deviation, query.mask);
  return high > low ? deviation[0] / (high - low) : 0;
}

double view_margin(const synthesis::PatchImage& query, const Members& members, Gallery& gallery,
                   const DepthOptions& options) {
  constexpr size_t objects = 4;
  constexpr double away = 30;
  if (!gallery.has_any_view() || members.images.empty()) return 0;
  const size_t count = std::min(objects, members.images.size());
  const auto from = [&](double yaw, double pitch) {
    Images some;
    for (size_t k = 0; k < count; ++k) {
      const render::View& v = members.views[k];
      some.push_back(gallery.small(members.objects[k], {v.yaw + yaw, std::clamp(v.pitch + pitch, -89., 89.)}));
      some.back().planes.resize(2);
    }
    return mean_distance(query, some, options);
  };
  const double here = from(0, 0);
  double least = 1e9;
  for (const auto& [yaw, pitch] :
       {std::pair(away, 0.), std::pair(-away, 0.), std::pair(0., away), std::pair(0., -away)})
    least = std::min(least, from(yaw, pitch));
  return here > 0 ? least / here : 0;
}

}  // namespace

Evidence gather_evidence(const synthesis::PatchImage& small, const ExampleSet& set, const DepthOptions& options) {
  const Members members = members_of(set);
  Evidence e;
  e.strangeness = strangeness(small, members.images, options);
  e.silhouette = 0;
  for (const synthesis::PatchImage& m : members.images)
    e.silhouette = std::max(e.silhouette, overlap(small.mask, m.mask));
  e.halves = difference_of_halves(small, members.images, options);
  e.view_margin = view_margin(small, members, set.gallery(), options);
  return e;
}

bool is_trusted(const Evidence& e) {
  if (!(e.strangeness < most_strangeness) || e.silhouette < least_overlap) return false;
  return e.view_margin > 0 ? e.view_margin >= least_margin : e.halves <= most_difference;
}

}  // namespace parts::depth
