// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/depth/segment.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "parts/base/error.h"
#include "parts/base/median.h"
#include "parts/depth/alignment.h"
#include "parts/depth/small_level.h"
#include "parts/synthesis/pyramid.h"

namespace parts::depth {
namespace {

constexpr int longest = 256;  ///< pixels at which colours are cut

cv::Mat smaller(const cv::Mat& image, int interpolation) {
  const double shrink = std::max(1., std::max(image.cols, image.rows) / double(longest));
  cv::Mat result;
  cv::resize(image, result, cv::Size(std::max(1, int(image.cols / shrink)), std::max(1, int(image.rows / shrink))), 0,
             0, interpolation);
  return result;
}

std::vector<cv::Vec3f> border_colors(const cv::Mat& color) {
  std::vector<cv::Vec3f> list;
  for (int y = 0; y < color.rows; ++y)
    for (int x = 0; x < color.cols; ++x)
      if (x < 2 || y < 2 || x >= color.cols - 2 || y >= color.rows - 2)
        list.push_back(cv::Vec3f(color.at<cv::Vec3b>(y, x)));
  return list;
}

// The largest component of a mask, without holes that are small.
cv::Mat main_component(const cv::Mat& mask) {
  cv::Mat labels, stats, centers;
  const int n = cv::connectedComponentsWithStats(mask, labels, stats, centers);
  int best = 0;
  for (int k = 1; k < n; ++k)
    if (best == 0 || stats.at<int>(k, cv::CC_STAT_AREA) > stats.at<int>(best, cv::CC_STAT_AREA)) best = k;
  if (best == 0) return cv::Mat::zeros(mask.size(), CV_8U);
  cv::Mat result = labels == best;
  const cv::Mat outside = ~result;
  const int area = stats.at<int>(best, cv::CC_STAT_AREA),
            holes = cv::connectedComponentsWithStats(outside, labels, stats, centers);
  for (int k = 1; k < holes; ++k)
    if (stats.at<int>(k, cv::CC_STAT_AREA) < area / 200) result.setTo(255, labels == k);
  return result;
}

// A silhouette laid over the image: how well intensities inside agree with the
// example's (correlation), and how much the image changes along its rim.
struct Template {
  std::vector<cv::Point> inside, rim;
  std::vector<float> value;  ///< of the example, a pixel inside
  cv::Mat mask;
};

Template make_template(const synthesis::PatchImage& example, double longest_side) {
  cv::Mat points;
  cv::findNonZero(example.mask, points);
  const cv::Rect box = cv::boundingRect(points);
  const double scale = longest_side / std::max(box.width, box.height);
  const cv::Size size(std::max(4, int(std::lround(box.width * scale))),
                      std::max(4, int(std::lround(box.height * scale))));
  Template t;
  cv::Mat grey, core;
  cv::resize(example.mask(box), t.mask, size, 0, 0, cv::INTER_LINEAR);
  cv::resize(synthesis::extend(example.planes[0], example.mask)(box), grey, size, 0, 0, cv::INTER_LINEAR);
  t.mask = t.mask > 127;
  cv::erode(t.mask, core, cv::Mat::ones(3, 3, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT, 0);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      if (!t.mask.at<uchar>(y, x)) continue;
      if (!core.at<uchar>(y, x)) t.rim.push_back({x, y});
      if ((x + y) % 2) continue;
      t.inside.push_back({x, y});
      t.value.push_back(grey.at<float>(y, x));
    }
  return t;
}

double fit(const Template& t, const cv::Mat& grey, const cv::Mat& change, double mean_change, int left, int top) {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0, rim = 0;
  for (size_t i = 0; i < t.inside.size(); ++i) {
    const double u = t.value[i], v = grey.at<float>(top + t.inside[i].y, left + t.inside[i].x);
    ++n, a += u, b += v, aa += u * u, bb += v * v, ab += u * v;
  }
  for (const cv::Point& p : t.rim) rim += std::min(4 * mean_change, double(change.at<float>(top + p.y, left + p.x)));
  const double va = aa - a * a / n, vb = bb - b * b / n;
  const double correlation = va > 1e-9 && vb > 1e-9 ? (ab - a * b / n) / std::sqrt(va * vb) : 0;
  return correlation + 0.5 * rim / (mean_change * double(t.rim.size()));
}

// Where, and how large, an example's silhouette fits the image best.
cv::Mat find_by_examples(const cv::Mat& color, Gallery& gallery, const DepthOptions& options) {
  const double shrink = std::max(color.cols, color.rows) / 64.;
  cv::Mat small;
  cv::resize(color, small, {std::max(8, int(color.cols / shrink)), std::max(8, int(color.rows / shrink))}, 0, 0,
             cv::INTER_AREA);
  const cv::Mat grey = intensity(small);
  cv::Mat change = cv::Mat::zeros(small.size(), CV_32F);
  for (int y = 1; y + 1 < small.rows; ++y)
    for (int x = 1; x + 1 < small.cols; ++x) {
      const cv::Vec3f dx = cv::Vec3f(small.at<cv::Vec3b>(y, x + 1)) - cv::Vec3f(small.at<cv::Vec3b>(y, x - 1));
      const cv::Vec3f dy = cv::Vec3f(small.at<cv::Vec3b>(y + 1, x)) - cv::Vec3f(small.at<cv::Vec3b>(y - 1, x));
      change.at<float>(y, x) = std::sqrt(dx.dot(dx) + dy.dot(dy));
    }
  const double mean_change = std::max(1e-3, cv::mean(change)[0]);
  double best = -1e30;
  cv::Mat result;
  const int objects = std::min(8, gallery.size());
  for (int i = 0; i < objects; ++i)
    for (double side = 0.4; side < 1.01; side += 0.075) {
      const Template t = make_template(gallery.small(i * gallery.size() / objects, options.views[0]), side * 64);
      if (t.inside.empty()) continue;
      for (int top = 0; top + t.mask.rows <= grey.rows; top += 2)
        for (int left = 0; left + t.mask.cols <= grey.cols; left += 2) {
          const double score = fit(t, grey, change, mean_change, left, top) * std::pow(side, 0.25);
          if (score <= best) continue;
          best = score;
          result = cv::Mat::zeros(grey.size(), CV_8U);
          t.mask.copyTo(result(cv::Rect(left, top, t.mask.cols, t.mask.rows)));
        }
    }
  if (result.empty()) return {};
  cv::Mat full;
  cv::resize(result, full, color.size(), 0, 0, cv::INTER_LINEAR);
  return full > 127;
}

cv::Mat first_guess(const cv::Mat& color, Gallery& gallery, const DepthOptions& options) {
  cv::Mat mask = plain_background_mask(color);
  if (!mask.empty()) mask = main_component(mask);
  if (mask.empty() || cv::countNonZero(mask) < int(mask.total() / 50)) mask = find_by_examples(color, gallery, options);
  if (mask.empty()) mask = cv::Mat(color.size(), CV_8U, cv::Scalar(255));
  return mask;
}

// Segmentation and depth synthesised together, in the examples' small frame.
cv::Mat synthesized(const DepthQuery& query, const Placement& placement, Gallery& gallery,
                    const DepthOptions& options) {
  const cv::Size frame = gallery.image_size();
  const cv::Mat all(frame, CV_8U, cv::Scalar(255));
  const synthesis::PatchImage look = place(query, placement, frame);
  DepthQuery whole = query;
  whole.mask = cv::Mat(query.color.size(), CV_8U, cv::Scalar(255));
  cv::Mat guess;
  look.mask.convertTo(guess, CV_32F, 1 / 255.);
  synthesis::PatchImage q = thumbnail({{place(whole, placement, frame).planes[0]}, all}, Gallery::thumbnail_size);
  q.planes.push_back(thumbnail({{guess}, all}, Gallery::thumbnail_size).planes[0]);
  const synthesis::PatchImage small_look = thumbnail(look, Gallery::thumbnail_size);

  std::vector<std::pair<double, int>> order;
  for (int k = 0; k < gallery.size(); ++k)
    order.push_back({image_difference(small_look, gallery.small(k, options.views[0])), k});
  std::sort(order.begin(), order.end());
  std::vector<synthesis::PatchImage> examples;
  for (int i = 0; i < std::min<int>(options.examples, int(order.size())); ++i) {
    const synthesis::PatchImage& e = gallery.small(order[i].second, options.views[0]);
    cv::Mat inside;
    e.mask.convertTo(inside, CV_32F, 1 / 255.);
    examples.push_back(
        {{synthesis::extend(e.planes[0], e.mask), inside, inside, synthesis::extend(e.planes[1], e.mask)},
         cv::Mat(e.mask.size(), CV_8U, cv::Scalar(255))});
  }
  synthesis::SynthesisOptions o = synthesis_options(options);
  o.channels = {{0, options.intensity, false, true},
                {1, 1, false, false},
                {2, 1, false, false},
                {3, options.depth, false, false}};
  o.synthesized = {2, 3};
  o.silhouette = 0;
  cv::Mat small = synthesize_small(q, examples, o, o.max_iterations).planes[0], full;
  cv::resize(small, full, frame, 0, 0, cv::INTER_LINEAR);
  return full;
}

}  // namespace

cv::Mat plain_background_mask(const cv::Mat& color) {
  const std::vector<cv::Vec3f> border = border_colors(color);
  std::vector<double> channel(border.size());
  cv::Vec3f middle;
  for (int c = 0; c < 3; ++c) {
    for (size_t i = 0; i < border.size(); ++i) channel[i] = border[i][c];
    middle[c] = float(median(channel));
  }
  size_t alike = 0;
  const auto is_background = [&](const cv::Vec3f& v) { return cv::norm(v - middle, cv::NORM_INF) <= 6; };
  for (const cv::Vec3f& v : border) alike += is_background(v);
  if (double(alike) < 0.9 * double(border.size())) return {};
  cv::Mat background(color.size(), CV_8U);
  for (int y = 0; y < color.rows; ++y)
    for (int x = 0; x < color.cols; ++x)
      background.at<uchar>(y, x) = is_background(cv::Vec3f(color.at<cv::Vec3b>(y, x))) ? 255 : 0;
  // Only what hangs together with the border: an object may have that colour too.
  cv::Mat labels, mask(color.size(), CV_8U, cv::Scalar(255));
  const int n = cv::connectedComponents(background, labels, 4);
  std::vector<char> touches(n, 0);
  for (int y = 0; y < color.rows; ++y)
    for (int x = 0; x < color.cols; ++x)
      if (x == 0 || y == 0 || x == color.cols - 1 || y == color.rows - 1) touches[labels.at<int>(y, x)] = 1;
  for (int y = 0; y < color.rows; ++y)
    for (int x = 0; x < color.cols; ++x)
      if (labels.at<int>(y, x) > 0 && touches[labels.at<int>(y, x)]) mask.at<uchar>(y, x) = 0;
  return mask;
}

cv::Mat segment(const DepthQuery& query, Gallery& gallery, const DepthOptions& options, Progress& progress) {
  DepthQuery guess;
  guess.color = smaller(query.color, cv::INTER_AREA);
  cv::Mat within(guess.color.size(), CV_8U, cv::Scalar(255));
  if (!query.mask.empty()) within = smaller(query.mask, cv::INTER_NEAREST);
  guess.mask = first_guess(guess.color, gallery, options) & within;
  if (cv::countNonZero(guess.mask) < 16) guess.mask = within;
  progress.at(0.2);

  const Placement placement = align_query(guess, gallery, options);
  const cv::Mat inside = synthesized(guess, placement, gallery, options);
  progress.at(0.6);
  cv::Mat share;
  cv::warpAffine(inside, share, placement.matrix(), guess.color.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);

  cv::Mat labels(share.size(), CV_8U), backgrounds, foregrounds;
  for (int y = 0; y < share.rows; ++y)
    for (int x = 0; x < share.cols; ++x) {
      const float s = share.at<float>(y, x);
      const bool out = !within.at<uchar>(y, x) || s < 0.02f;
      labels.at<uchar>(y, x) = uchar(out         ? cv::GC_BGD
                                     : s > 0.97f ? cv::GC_FGD
                                     : s > 0.5f  ? cv::GC_PR_FGD
                                                 : cv::GC_PR_BGD);
    }
  // What the examples leave open at the silhouette is open, whatever they say.
  cv::Mat core, reach;
  cv::erode(labels == cv::GC_FGD, core, cv::Mat::ones(9, 9, CV_8U));
  cv::dilate(labels != cv::GC_BGD, reach, cv::Mat::ones(9, 9, CV_8U));
  labels.setTo(cv::GC_PR_FGD, (labels == cv::GC_FGD) & ~core);
  labels.setTo(cv::GC_PR_BGD, (labels == cv::GC_BGD) & reach & within);
  const bool both = cv::countNonZero((labels == cv::GC_BGD) | (labels == cv::GC_PR_BGD)) > 0 &&
                    cv::countNonZero((labels == cv::GC_FGD) | (labels == cv::GC_PR_FGD)) > 0;
  if (both) {
    cv::theRNG().state = 1;  // its clustering starts from random colours
    cv::grabCut(guess.color, labels, {}, backgrounds, foregrounds, 4, cv::GC_INIT_WITH_MASK);
  }
  progress.at(0.9);
  cv::Mat mask = main_component((labels == cv::GC_FGD) | (labels == cv::GC_PR_FGD)), result;
  // Where colours do not tell object and background apart, the examples alone do.
  const cv::Mat by_examples = (share > 0.5f) & within;
  if (cv::countNonZero(mask & by_examples) < 0.6 * cv::countNonZero(mask | by_examples))
    mask = main_component(by_examples);
  if (cv::countNonZero(mask) < int(mask.total() / 200))
    throw UserError("No object was found in the image; give a mask that shows where it is.");
  cv::resize(mask, result, query.color.size(), 0, 0, cv::INTER_LINEAR);
  return result > 127;
}

}  // namespace parts::depth
