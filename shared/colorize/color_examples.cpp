// SPDX-License-Identifier: GPL-3.0-or-later
#include "colorize/color_examples.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <random>

#include "geometry/error.h"
#include "raster/mask.h"

namespace parts {
namespace {

/// Mean squared difference of two reliefs whose centroids coincide; where one
/// has no foreground, as large as the larger relief.
double relief_difference(const PatchImage& a, const PatchImage& b) {
  const cv::Point2d shift = centroid(a.mask) - centroid(b.mask);
  const cv::Matx23d move(1, 0, shift.x, 0, 1, shift.y);
  cv::Mat moved, mask;
  cv::warpAffine(b.planes[kReliefPlane], moved, move, a.mask.size(), cv::INTER_LINEAR);
  cv::warpAffine(b.mask, mask, move, a.mask.size(), cv::INTER_NEAREST);
  const cv::Mat both = a.mask & mask, either = a.mask | mask;
  const int common = cv::countNonZero(both), all = cv::countNonZero(either);
  const double miss = std::pow(2 * relief_spread(a), 2);
  if (common == 0) return miss;
  cv::Mat squared = a.planes[kReliefPlane] - moved;
  squared = squared - cv::mean(squared, both)[0];
  squared = squared.mul(squared);
  return (cv::mean(squared, both)[0] * common + miss * (all - common)) / all;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

cv::Vec3d mean_color(const PatchImage& image) {
  cv::Vec3d mean;
  for (int k = kYPlane; k <= kCrPlane; ++k) mean[k - kYPlane] = cv::mean(image.planes[k], image.mask)[0];
  return mean;
}

}  // namespace

cv::Mat relief(const cv::Mat& depth, const cv::Mat& mask, double pixels_per_unit) {
  cv::Mat d = depth.clone();
  d.setTo(0, mask == 0);
  const double mean = cv::mean(d, mask)[0];
  d = (d - mean) * pixels_per_unit;
  d.setTo(0, mask == 0);
  return d;
}

double relief_spread(const PatchImage& image) {
  cv::Scalar mean, spread;
  cv::meanStdDev(image.planes[kReliefPlane], mean, spread, image.mask);
  return spread[0];
}

PatchImage color_planes(const Example& e) {
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

std::vector<int> choosable(const std::vector<std::string>& names, const std::vector<std::string>& labels) {
  std::vector<int> objects;
  std::vector<char> found(labels.size(), 0);
  for (int object = 0; object < int(names.size()); ++object) {
    const auto label = std::find_if(labels.begin(), labels.end(), [&](const std::string& l) {
      return names[object] == l || std::filesystem::path(names[object]).stem() == l;
    });
    if (!labels.empty() && label == labels.end()) continue;
    objects.push_back(object);
    if (!labels.empty()) found[label - labels.begin()] = 1;
  }
  for (std::size_t i = 0; i < found.size(); ++i)
    if (!found[i])
      throw UserError("The database has no example '" + labels[i] + "'; Choose takes labels of its objects.");
  return objects;
}

void select_examples(std::vector<ColorExample>& all, const PatchImage& query, const ColorizeOptions& options) {
  if (options.examples < 1) throw UserError("Examples must be 1 or more; 1 morphs one image-map onto the shape.");
  constexpr double kColorStep = 0.08;  // counts as much as the median difference in shape
  for (ColorExample& c : all) c.difference = relief_difference(query, c.image);
  std::stable_sort(all.begin(), all.end(),
                   [](const ColorExample& a, const ColorExample& b) { return a.difference < b.difference; });
  if (!options.choose.empty()) return;
  if (options.seed != 0) {
    std::mt19937 engine(options.seed);
    std::swap(all[0], all[engine() % unsigned((all.size() + 1) / 2)]);
  }
  const double typical = std::max(all[all.size() / 2].difference, 1e-12);
  const cv::Vec3d like = mean_color(all[0].image);
  const auto cost = [&](const ColorExample& c) {
    return c.difference / typical + std::pow(cv::norm(mean_color(c.image) - like) / kColorStep, 2);
  };
  std::stable_sort(all.begin() + 1, all.end(),
                   [&](const ColorExample& a, const ColorExample& b) { return cost(a) < cost(b); });
  all.resize(std::min(all.size(), std::size_t(options.examples)));
}

bool harmonize(PatchImage& image, const PatchImage& like) {
  const cv::Point2d shift = centroid(like.mask) - centroid(image.mask);
  bool changed = false;
  for (int k = kYPlane; k <= kCrPlane; ++k) {
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
    if (std::abs(step) < (k == kYPlane ? 0.04 : 0.012) || spread > 0.7 * std::abs(step)) continue;
    image.planes[k] += step;
    changed = true;
  }
  return changed;
}

SynthesisOptions color_synthesis(const ColorizeOptions& options) {
  SynthesisOptions s;
  s.channels = {{kReliefPlane, options.weight_depth, false, true},
                {kReliefPlane, options.weight_detail, true, false},
                {kYPlane, options.weight_y, false, false},
                {kCbPlane, options.weight_cb, false, false},
                {kCrPlane, options.weight_cr, false, false}};
  s.synthesized = {kYPlane, kCbPlane, kCrPlane};
  s.patch_sizes = options.patch_sizes;
  s.position = options.weight_position;
  s.max_iterations = options.max_iterations;
  s.pca_share = options.pca_share;
  s.threads = options.threads;
  return s;
}

cv::Mat to_color(const std::vector<cv::Mat>& ycbcr) {
  cv::Mat bands[3], ycc, color;
  const int order[3] = {0, 2, 1};
  for (int k = 0; k < 3; ++k) ycbcr[order[k]].convertTo(bands[k], CV_8U, 255);
  cv::merge(bands, 3, ycc);
  cv::cvtColor(ycc, color, cv::COLOR_YCrCb2BGR);
  return color;
}

std::vector<PatchImage> prepare_examples(std::vector<ColorExample> examples, bool harmonized, ColorizeReport& report) {
  std::vector<PatchImage> images;
  for (ColorExample& e : examples) {
    report.used.push_back(e.name);
    if (harmonized && !images.empty() && harmonize(e.image, images.front()))
      report.harmonized.push_back(report.used.back());
    images.push_back(std::move(e.image));
  }
  return images;
}

void report_synthesis(const SynthesisResult& found, const cv::Mat& mask, ColorizeReport& report) {
  report.objective = found.objective;
  const cv::Mat squared = found.distance.mul(found.distance);
  report.patch_distance = std::sqrt(cv::mean(squared, mask)[0]);
  const double foreground = double(cv::countNonZero(found.example >= 0));
  for (std::size_t k = 0; k < report.used.size(); ++k)
    report.shares.push_back(cv::countNonZero(found.example == int(k)) / foreground);
}

}  // namespace parts
