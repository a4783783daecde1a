// SPDX-License-Identifier: GPL-3.0-or-later
#include "colorize/colorize_depth.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <random>

#include "geometry/error.h"
#include "raster/mask.h"
#include "raster/raster_io.h"
#include "synthesis/pyramid.h"
#include "synthesis/synthesis.h"

namespace parts {
namespace {

enum Plane { kDepth, kY, kCb, kCr };

double reach(const cv::Mat& mask) { return std::sqrt(double(cv::countNonZero(mask))); }

/// The relief in pixels about its mean, NaN as 0.
cv::Mat relief(const cv::Mat& depth, const cv::Mat& mask, double pixels_per_unit) {
  cv::Mat d = depth.clone();
  d.setTo(0, mask == 0);
  const double mean = cv::mean(d, mask)[0];
  d = (d - mean) * pixels_per_unit;
  d.setTo(0, mask == 0);
  return d;
}

double deviation(const cv::Mat& plane, const cv::Mat& mask) {
  cv::Scalar mean, sd;
  cv::meanStdDev(plane, mean, sd, mask);
  return sd[0];
}

/// An example as planes {relief, Y, Cb, Cr}, colours 0..1.
struct Candidate {
  int object = 0;
  double difference = 0;  ///< of its relief to the query's
  PatchImage image;
};

PatchImage planes_of(const Example& e) {
  PatchImage p;
  p.mask = e.mask;
  p.planes.push_back(relief(e.depth, e.mask, e.pixels_per_unit()));
  cv::Mat ycc;
  cv::cvtColor(e.image, ycc, cv::COLOR_BGR2YCrCb);
  std::vector<cv::Mat> bands;
  cv::split(ycc, bands);
  for (int k : {0, 2, 1}) {  // OpenCV's order is Y, Cr, Cb
    cv::Mat plane;
    bands[k].convertTo(plane, CV_32F, 1 / 255.);
    p.planes.push_back(plane);
  }
  return p;
}

/// Mean squared difference of two reliefs whose centroids coincide; where one
/// has no foreground, as large as the larger relief.
double relief_difference(const PatchImage& a, const PatchImage& b) {
  const cv::Point2d shift = centroid(a.mask) - centroid(b.mask);
  const cv::Matx23d move(1, 0, shift.x, 0, 1, shift.y);
  cv::Mat moved, mask;
  cv::warpAffine(b.planes[kDepth], moved, move, a.mask.size(), cv::INTER_LINEAR);
  cv::warpAffine(b.mask, mask, move, a.mask.size(), cv::INTER_NEAREST);
  const cv::Mat both = a.mask & mask, either = a.mask | mask;
  const int common = cv::countNonZero(both), all = cv::countNonZero(either);
  const double miss = std::pow(2 * deviation(a.planes[kDepth], a.mask), 2);
  if (common == 0) return miss;
  cv::Mat squared = a.planes[kDepth] - moved;
  squared = squared - cv::mean(squared, both)[0];
  squared = squared.mul(squared);
  return (cv::mean(squared, both)[0] * common + miss * (all - common)) / all;
}

/// How the query's pixels map into the examples' frame.
struct Frame {
  cv::Matx23d matrix{1, 0, 0, 0, 1, 0};
  bool moved = false;
};

/// As it is where it lies in the frame like the others; else centroid on
/// centroid, as large as they are.
Frame fit(const cv::Mat& mask, cv::Size frame, double typical_reach, const cv::Point2d& typical_center) {
  const double scale = typical_reach / reach(mask);
  const cv::Point2d center = centroid(mask);
  Frame f;
  f.moved =
      mask.size() != frame || scale > 1.25 || scale < 0.8 || cv::norm(center - typical_center) > 0.1 * typical_reach;
  if (f.moved)
    f.matrix = {scale, 0, typical_center.x - scale * center.x, 0, scale, typical_center.y - scale * center.y};
  return f;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// Takes off an example what makes it differ from another all over: exposure or
/// tint. What differs here and there (a red coat and a blue one) is no tint.
/// @return whether there was such a difference
bool harmonize(PatchImage& image, const PatchImage& like) {
  const cv::Point2d shift = centroid(like.mask) - centroid(image.mask);
  bool changed = false;
  for (int k = kY; k <= kCr; ++k) {
    std::vector<double> steps;
    for (int y = 0; y < image.mask.rows; ++y)
      for (int x = 0; x < image.mask.cols; ++x) {
        const cv::Point q(cvRound(x + shift.x), cvRound(y + shift.y));
        if (!image.mask.at<uchar>(y, x) || !cv::Rect(0, 0, like.mask.cols, like.mask.rows).contains(q)) continue;
        if (like.mask.at<uchar>(q)) steps.push_back(like.planes[k].at<float>(q) - image.planes[k].at<float>(y, x));
      }
    if (steps.empty()) continue;
    const double step = median(steps);
    for (double& s : steps) s = std::abs(s - step);
    const double spread = median(std::move(steps));
    if (std::abs(step) < (k == kY ? 0.04 : 0.012) || spread > 0.7 * std::abs(step)) continue;
    image.planes[k] += step;
    changed = true;
  }
  return changed;
}

std::vector<Candidate> load(ExampleSource& source, const ColorizeOptions& options, Progress& progress) {
  std::vector<Candidate> all;
  std::vector<char> named(options.choose.size(), 0);
  for (int object = 0; object < source.size(); ++object) {
    if (!options.choose.empty()) {
      const auto label = std::find_if(options.choose.begin(), options.choose.end(), [&](const std::string& l) {
        return source.name(object) == l || std::filesystem::path(source.name(object)).stem() == l;
      });
      if (label == options.choose.end()) continue;
      named[label - options.choose.begin()] = 1;
    }
    progress.at(double(object) / source.size());
    Candidate c;
    c.object = object;
    c.image = planes_of(source.get(object, options.view));
    all.push_back(std::move(c));
  }
  for (std::size_t i = 0; i < named.size(); ++i)
    if (!named[i])
      throw UserError("The database has no example '" + options.choose[i] + "'; Choose takes labels of its objects.");
  return all;
}

cv::Vec3d mean_color(const PatchImage& image) {
  cv::Vec3d mean;
  for (int k = kY; k <= kCr; ++k) mean[k - kY] = cv::mean(image.planes[k], image.mask)[0];
  return mean;
}

/// Keeps the most similar ones, the best first; with a seed, that one is drawn
/// among the better half. The others are to go with its colours.
void select(std::vector<Candidate>& all, const PatchImage& query, const ColorizeOptions& options) {
  constexpr double kColorStep = 0.08;  // counts as much as the median difference in shape
  for (Candidate& c : all) c.difference = relief_difference(query, c.image);
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.difference < b.difference; });
  if (!options.choose.empty()) return;
  if (options.seed != 0) {
    std::mt19937 engine(options.seed);
    std::swap(all[0], all[engine() % unsigned((all.size() + 1) / 2)]);
  }
  const double typical = std::max(all[all.size() / 2].difference, 1e-12);
  const cv::Vec3d like = mean_color(all[0].image);
  const auto cost = [&](const Candidate& c) {
    return c.difference / typical + std::pow(cv::norm(mean_color(c.image) - like) / kColorStep, 2);
  };
  std::stable_sort(all.begin() + 1, all.end(),
                   [&](const Candidate& a, const Candidate& b) { return cost(a) < cost(b); });
  all.resize(std::min(all.size(), std::size_t(options.examples)));
}

SynthesisOptions engine_options(const ColorizeOptions& options) {
  SynthesisOptions s;
  s.channels = {{kDepth, options.weight_depth, false, true},
                {kDepth, options.weight_detail, true, false},
                {kY, options.weight_y, false, false},
                {kCb, options.weight_cb, false, false},
                {kCr, options.weight_cr, false, false}};
  s.synthesized = {kY, kCb, kCr};
  s.patch_sizes = options.patch_sizes;
  s.position = options.weight_position;
  s.max_iterations = options.max_iterations;
  s.pca_share = options.pca_share;
  s.threads = options.threads;
  return s;
}

/// The nearest foreground pixel's source where the frame's mask did not reach.
void fill_sources(ColorizeResult& result) {
  const cv::Mat missing = (result.example < 0) & (result.mask != 0);
  if (cv::countNonZero(missing) == 0) return;
  cv::Mat distance, label;
  cv::distanceTransform(result.example < 0, distance, label, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Point> where(result.example.total() + 1);
  for (int y = 0; y < label.rows; ++y)
    for (int x = 0; x < label.cols; ++x)
      if (result.example.at<int>(y, x) >= 0) where[label.at<int>(y, x)] = {x, y};
  for (int y = 0; y < label.rows; ++y)
    for (int x = 0; x < label.cols; ++x)
      if (missing.at<uchar>(y, x)) {
        const cv::Point p = where[label.at<int>(y, x)];
        result.example.at<int>(y, x) = result.example.at<int>(p);
        result.source.at<cv::Vec2i>(y, x) = result.source.at<cv::Vec2i>(p);
      }
}

cv::Mat to_color(const std::vector<cv::Mat>& ycbcr) {
  cv::Mat bands[3], ycc, color;
  const int order[3] = {0, 2, 1};
  for (int k = 0; k < 3; ++k) ycbcr[order[k]].convertTo(bands[k], CV_8U, 255);
  cv::merge(bands, 3, ycc);
  cv::cvtColor(ycc, color, cv::COLOR_YCrCb2BGR);
  return color;
}

void check(const cv::Mat& mask, const ColorizeOptions& options) {
  if (options.examples < 1) throw UserError("Examples must be 1 or more; 1 morphs one image-map onto the shape.");
  if (cv::countNonZero(mask) < 16)
    throw UserError("The depth map has next to no foreground; 0, NaN and infinity are background.");
}

}  // namespace

ColorizeResult colorize_depth(const cv::Mat& depth, ExampleSource& source, const ColorizeOptions& options,
                              Progress& progress) {
  ColorizeResult result;
  result.mask = depth_mask(depth);
  check(result.mask, options);
  progress.stage("Reading examples", 0, 20);
  std::vector<Candidate> examples = load(source, options, progress);

  std::vector<double> reaches, reliefs, xs, ys;
  for (const Candidate& c : examples) {
    const cv::Point2d center = centroid(c.image.mask);
    reaches.push_back(reach(c.image.mask)), xs.push_back(center.x), ys.push_back(center.y);
    reliefs.push_back(deviation(c.image.planes[kDepth], c.image.mask) / reaches.back());
  }
  const Frame frame = fit(result.mask, source.image_size(), median(reaches), {median(xs), median(ys)});
  result.aligned = frame.moved;
  PatchImage query;
  query.planes.resize(4);
  cv::Mat full = extend(relief(depth, result.mask, 1), result.mask);
  if (frame.moved) {
    cv::warpAffine(full, full, frame.matrix, source.image_size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::warpAffine(result.mask, query.mask, frame.matrix, source.image_size(), cv::INTER_LINEAR);
    query.mask = query.mask >= 128;
    check(query.mask, options);
  } else {
    query.mask = result.mask;
  }
  const double range = deviation(full, query.mask);
  full.setTo(0, query.mask == 0);
  query.planes[kDepth] = range > 0 ? cv::Mat(full * (median(reliefs) * reach(query.mask) / range)) : full;

  select(examples, query, options);
  std::vector<PatchImage> images;
  for (Candidate& c : examples) {
    result.used.push_back(source.name(c.object));
    if (options.harmonize && !images.empty() && harmonize(c.image, images.front()))
      result.harmonized.push_back(result.used.back());
    images.push_back(std::move(c.image));
  }
  Progress rest = progress.part(20, 100);
  const SynthesisResult found = synthesize(query, images, engine_options(options), {}, rest);

  result.objective = found.objective;
  result.example = found.example, result.source = found.source;
  cv::Mat squared = found.distance.mul(found.distance);
  result.patch_distance = std::sqrt(cv::mean(squared, query.mask)[0]);
  std::vector<cv::Mat> planes = found.planes;
  if (frame.moved) {
    const int back = cv::WARP_INVERSE_MAP;
    for (cv::Mat& plane : planes) {
      plane = extend(plane, query.mask);
      cv::warpAffine(plane, plane, frame.matrix, depth.size(), cv::INTER_CUBIC | back, cv::BORDER_REPLICATE);
    }
    cv::Mat index, pixel;
    found.example.convertTo(index, CV_32F);
    found.source.convertTo(pixel, CV_32F);
    cv::warpAffine(index, index, frame.matrix, depth.size(), cv::INTER_NEAREST | back, cv::BORDER_REPLICATE);
    cv::warpAffine(pixel, pixel, frame.matrix, depth.size(), cv::INTER_NEAREST | back, cv::BORDER_REPLICATE);
    index.convertTo(result.example, CV_32S);
    pixel.convertTo(result.source, CV_32S);
    result.example.setTo(-1, result.mask == 0);
    fill_sources(result);
  }
  result.color = to_color(planes);
  result.color.setTo(0, result.mask == 0);
  result.example.setTo(-1, result.mask == 0);
  for (std::size_t k = 0; k < result.used.size(); ++k)
    result.shares.push_back(cv::countNonZero(result.example == int(k)) / double(cv::countNonZero(result.mask)));
  return result;
}

}  // namespace parts
