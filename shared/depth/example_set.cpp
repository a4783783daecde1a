// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/depth/example_set.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "parts/depth/alignment.h"
#include "parts/render/mask.h"

namespace parts::depth {
namespace {

constexpr double same_view = 5;  ///< degrees

bool same(const render::View& a, const render::View& b) { return a.yaw == b.yaw && a.pitch == b.pitch; }

cv::Mat halved(const cv::Mat& plane, int times) {
  cv::Mat result = plane;
  for (int i = 0; i < times; ++i) {
    cv::Mat half;
    cv::pyrDown(result, half);
    result = half;
  }
  return result;
}

// (D - Di)^2 over the foreground, centroids and means aligned.
double depth_difference(const cv::Mat& estimate, const cv::Mat& mask, const cv::Mat& depth, const cv::Mat& depth_mask,
                        double scale) {
  const cv::Point2d shift = render::centroid(mask) - render::centroid(depth_mask);
  const int dx = int(std::lround(shift.x)), dy = int(std::lround(shift.y));
  double n = 0, sum = 0, squares = 0;
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) {
      if (!mask.at<uchar>(y, x)) continue;
      const int u = std::clamp(x - dx, 0, depth.cols - 1), v = std::clamp(y - dy, 0, depth.rows - 1);
      const double d = estimate.at<float>(y, x) - scale * depth.at<float>(v, u);
      ++n, sum += d, squares += d * d;
    }
  return n > 0 ? squares / n - sum / n * (sum / n) : 1e30;
}

}  // namespace

ExampleSet::ExampleSet(Gallery& gallery, const DepthOptions& options, const std::vector<render::View>& views,
                       const synthesis::PatchImage& small)
    : gallery_(gallery), options_(options) {
  // A database of stored views may have the same one for several that are asked for.
  struct Candidate {
    double difference;
    int object;
    render::View view;
  };
  synthesis::ExampleChange ignored;
  const int each = std::max(1, options.examples / int(views.size()));
  for (const render::View& v : views) {
    std::vector<Candidate> list;
    for (int k = 0; k < gallery.size(); ++k)
      list.push_back({image_difference(small, gallery.small(k, v)), k, gallery.nearest(k, v)});
    std::stable_sort(list.begin(), list.end(),
                     [](const Candidate& a, const Candidate& b) { return a.difference < b.difference; });
    int added = 0;
    for (const Candidate& c : list) {
      if (added >= each || int(all_.size()) >= options.examples) break;
      const bool there = std::any_of(all_.begin(), all_.end(), [&](const ComparableExample& p) {
        return p.object == c.object && same(p.view, c.view);
      });
      if (!there) add(c.object, c.view, ignored), ++added;
    }
  }
}

synthesis::PatchImage ExampleSet::front(size_t k) const {
  synthesis::PatchImage e = all_[k].image;
  e.planes.resize(2);
  return e;
}

void ExampleSet::add(int object, const render::View& view, synthesis::ExampleChange& change) {
  all_.push_back(gallery_.get(object, view));
  change.add.push_back(front(all_.size() - 1));
}

bool ExampleSet::in_use(const synthesis::SynthesisState& state, int object, const render::View& view) const {
  for (size_t k = 0; k < state.active.size(); ++k)
    if (state.active[k] && all_[k].object == object && same(all_[k].view, view)) return true;
  return false;
}

std::vector<int> ExampleSet::nearest_objects(const synthesis::SynthesisState& state, const render::View& view,
                                             int count) const {
  std::vector<std::pair<double, int>> list;
  for (int k = 0; k < gallery_.size(); ++k) {
    if (in_use(state, k, gallery_.nearest(k, view))) continue;
    const synthesis::PatchImage& e = gallery_.small(k, view);
    // Both at the coarser of their scales.
    const int shrunk = int(std::lround(std::log2(double(gallery_.image_size().width) / e.mask.cols)));
    const int level = std::max(shrunk, state.level);
    const cv::Mat estimate = halved(state.planes[1], level - state.level);
    const cv::Mat mask = halved(state.mask, level - state.level) > 127;
    const cv::Mat depth = halved(e.planes[1], level - shrunk);
    const cv::Mat depth_mask = halved(e.mask, level - shrunk) > 127;
    list.push_back({depth_difference(estimate, mask, depth, depth_mask, double(1 << shrunk)), k});
  }
  std::sort(list.begin(), list.end());
  std::vector<int> objects;
  for (const auto& [difference, k] : list)
    if (int(objects.size()) < count) objects.push_back(k);
  return objects;
}

synthesis::ExampleChange ExampleSet::update(const synthesis::SynthesisState& state) {
  struct InUse {
    render::View view;
    double patches = 0;
    std::vector<int> examples;
  };
  std::vector<InUse> views;
  std::vector<std::pair<long, int>> by_use;
  double total = 0, yaw = 0, pitch = 0;
  for (size_t k = 0; k < state.active.size(); ++k) {
    if (!state.active[k]) continue;
    by_use.push_back({state.used[k], int(k)});
    auto v = std::find_if(views.begin(), views.end(), [&](const InUse& u) { return same(u.view, all_[k].view); });
    if (v == views.end()) v = views.insert(views.end(), InUse{all_[k].view, 0, {}});
    v->patches += double(state.used[k]);
    v->examples.push_back(int(k));
    total += double(state.used[k]), yaw += double(state.used[k]) * all_[k].view.yaw;
    pitch += double(state.used[k]) * all_[k].view.pitch;
  }
  synthesis::ExampleChange change;
  if (total <= 0) return change;
  std::stable_sort(views.begin(), views.end(), [](const InUse& a, const InUse& b) { return a.patches < b.patches; });

  render::View view = views.back().view;  // of new objects: the most used
  if (options_.update_views && views.size() > 1) {
    const render::View mean = gallery_.nearest(0, {yaw / total, pitch / total});
    const bool close = std::any_of(views.begin(), views.end(),
                                   [&](const InUse& u) { return render::angle_between(u.view, mean) < same_view; });
    if (!close) {
      const std::vector<int> objects = nearest_objects(state, mean, int(views.front().examples.size()));
      change.drop = views.front().examples;
      for (int k : objects) add(k, mean, change);
      return change;
    }
  }
  if (!options_.update_objects) return change;
  std::sort(by_use.begin(), by_use.end());
  const std::vector<int> objects = nearest_objects(state, view, std::max(1, int(by_use.size()) / 4));
  for (size_t i = 0; i < objects.size(); ++i) {
    change.drop.push_back(by_use[i].second);
    add(objects[i], view, change);
  }
  return change;
}

}  // namespace parts::depth
