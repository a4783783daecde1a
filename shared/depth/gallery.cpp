// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/depth/gallery.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <random>

#include "parts/base/error.h"
#include "parts/synthesis/pyramid.h"

namespace parts::depth {

cv::Mat intensity(const cv::Mat& color) {
  cv::Mat grey, result;
  cv::cvtColor(color, grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(result, CV_32F, 1 / 255.);
  return result;
}

synthesis::PatchImage thumbnail(const synthesis::PatchImage& image, int longest) {
  int levels = 1;
  while ((std::max(image.mask.cols, image.mask.rows) >> (levels - 1)) > longest) ++levels;
  if (levels == 1) return image;
  synthesis::PatchImage result;
  cv::Mat coverage;
  cv::Mat(image.mask != 0).convertTo(coverage, CV_32F, 1 / 255.);
  const cv::Mat small = synthesis::gaussian_pyramid(coverage, levels).back();
  result.mask = small >= 0.5f;
  if (cv::countNonZero(result.mask) == 0) result.mask = small > 0;  // thinner than a pixel
  for (size_t p = 0; p < image.planes.size(); ++p) {
    if (image.planes[p].empty()) {
      result.planes.emplace_back();
      continue;
    }
    cv::Mat plane = synthesis::gaussian_pyramid(synthesis::extend(image.planes[p], image.mask), levels).back();
    if (p > 0) plane /= double(1 << (levels - 1));  // depths are in pixels
    result.planes.push_back(plane);
  }
  return result;
}

Gallery::Gallery(examples::ExampleSource& source, int most, unsigned seed) : source_(source) {
  for (int i = 0; i < source.size(); ++i) objects_.push_back(i);
  if (source.size() > most) {
    std::mt19937 engine(seed);
    for (int i = 0; i < most; ++i)  // not std::shuffle, which differs between libraries
      std::swap(objects_[i], objects_[i + int(engine() % unsigned(source.size() - i))]);
    objects_.resize(most);
    std::sort(objects_.begin(), objects_.end());
  }
  for (int object : objects_)
    for (const render::View& v : source.views(object)) {
      any_view_ = false;
      const bool known = std::any_of(views_.begin(), views_.end(),
                                     [&](const render::View& w) { return w.yaw == v.yaw && w.pitch == v.pitch; });
      if (!known) views_.push_back(v);
    }
}

void Gallery::set_light(const examples::Light& light) {
  source_.set_light(light);
  small_.clear();
}

render::View Gallery::nearest(int k, const render::View& view) const {
  render::View best = view;
  double least = 1e30;
  for (const render::View& v : source_.views(objects_[k]))
    if (const double a = render::angle_between(v, view); a < least) least = a, best = v;
  return best;
}

namespace {

// Fills pits a few pixels wide: rays that slip between lips or through a crack
// would come out as spikes wherever the example is used.
cv::Mat without_pits(const cv::Mat& depth, const cv::Mat& mask) {
  double low, high;
  cv::minMaxLoc(depth, &low, &high, nullptr, nullptr, mask);
  const int side = std::max(3, std::max(depth.cols, depth.rows) / 60 | 1);
  const cv::Mat full = synthesis::extend(depth, mask), window = cv::Mat::ones(side, side, CV_8U);
  cv::Mat opened, result = depth.clone();
  cv::morphologyEx(full, opened, cv::MORPH_OPEN, window);
  opened.copyTo(result, (full - opened > 0.04 * (high - low)) & mask);
  return result;
}

}  // namespace

ComparableExample Gallery::get(int k, const render::View& view) {
  const examples::Example e = source_.get(objects_[k], view);
  ComparableExample p;
  p.object = k;
  p.view = e.view;
  p.camera = e.camera;
  p.pixels_per_unit = e.pixels_per_unit();
  p.middle = cv::mean(e.depth, e.mask)[0];
  p.image.mask = e.mask;
  p.image.planes = {intensity(e.image), (without_pits(e.depth, e.mask) - p.middle) * p.pixels_per_unit};
  if (!e.back_depth.empty()) p.image.planes.push_back((e.back_depth - p.middle) * p.pixels_per_unit);
  return p;
}

const synthesis::PatchImage& Gallery::small(int k, const render::View& view) {
  const render::View v = nearest(k, view);
  const auto key = std::make_tuple(k, v.yaw, v.pitch);
  const auto found = small_.find(key);
  if (found != small_.end()) return found->second;
  return small_.emplace(key, thumbnail(get(k, v).image, thumbnail_size)).first->second;
}

}  // namespace parts::depth
