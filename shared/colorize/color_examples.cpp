// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/colorize/color_examples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <random>

#include "parts/base/error.h"
#include "parts/base/median.h"
#include "parts/render/mask.h"

namespace parts::colorize {
double relief_difference(const synthesis::PatchImage& a, const synthesis::PatchImage& b, bool centered) {
  const cv::Point2d shift = centered ? render::centroid(a.mask) - render::centroid(b.mask) : cv::Point2d();
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

cv::Mat relief(const cv::Mat& depth, const cv::Mat& mask, double pixels_per_unit) {
  cv::Mat d = depth.clone();
  d.setTo(0, mask == 0);
  const double mean = cv::mean(d, mask)[0];
  d = (d - mean) * pixels_per_unit;
  d.setTo(0, mask == 0);
  return d;
}

double relief_spread(const synthesis::PatchImage& image) {
  cv::Scalar mean, spread;
  cv::meanStdDev(image.planes[kReliefPlane], mean, spread, image.mask);
  return spread[0];
}

synthesis::PatchImage color_planes(const examples::Example& e) {
  synthesis::PatchImage p;
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

namespace {

/// What each pixel of an image would have to be changed by to be as the pixel
/// at the same place of another; one list a colour plane.
std::array<std::vector<double>, 3> steps_between(const synthesis::PatchImage& image, const synthesis::PatchImage& like,
                                                 bool centered) {
  const cv::Point2d shift = centered ? render::centroid(like.mask) - render::centroid(image.mask) : cv::Point2d();
  const cv::Rect frame({0, 0}, like.mask.size());
  std::array<std::vector<double>, 3> steps;
  for (int y = 0; y < image.mask.rows; ++y)
    for (int x = 0; x < image.mask.cols; ++x) {
      const cv::Point q(cvRound(x + shift.x), cvRound(y + shift.y));
      if (!image.mask.at<uchar>(y, x) || !frame.contains(q) || !like.mask.at<uchar>(q)) continue;
      for (int k = kYPlane; k <= kCrPlane; ++k)
        steps[k - kYPlane].push_back(like.planes[k].at<float>(q) - image.planes[k].at<float>(y, x));
    }
  return steps;
}

/// What differs all over between two images; 0 where nothing does. What differs
/// here and there (a red coat and a blue one) is no tint.
cv::Vec3d tint(const std::array<std::vector<double>, 3>& steps) {
  cv::Vec3d all;
  for (int k = 0; k < 3; ++k) {
    if (steps[k].empty()) continue;
    std::vector<double> rest = steps[k];
    const double step = median(rest);
    for (double& s : rest) s = std::abs(s - step);
    const double spread = median(std::move(rest));
    if (std::abs(step) >= (k == 0 ? 0.04 : 0.012) && spread <= 0.7 * std::abs(step)) all[k] = step;
  }
  return all;
}

}  // namespace

bool harmonize(synthesis::PatchImage& image, const synthesis::PatchImage& like, bool centered) {
  const cv::Vec3d step = tint(steps_between(image, like, centered));
  for (int k = 0; k < 3; ++k)
    if (step[k] != 0) image.planes[kYPlane + k] += step[k];
  return step != cv::Vec3d();
}

double discord(const synthesis::PatchImage& image, const synthesis::PatchImage& like, const ColorizeOptions& options) {
  constexpr double kOther = 0.1;  // of Y or Cb or Cr: as skin differs from hair or a shirt
  const auto steps = steps_between(image, like, options.centered);
  const cv::Vec3d taken = options.harmonize ? tint(steps) : cv::Vec3d();
  if (steps[0].empty()) return 1;
  long other = 0;
  for (std::size_t i = 0; i < steps[0].size(); ++i) {
    double square = 0;
    for (int k = 0; k < 3; ++k) square += std::pow(steps[k][i] - taken[k], 2);
    other += square > kOther * kOther;
  }
  return double(other) / double(steps[0].size());
}

void select_examples(std::vector<ColorExample>& all, const synthesis::PatchImage& query,
                     const synthesis::PatchImage& kept, const ColorizeOptions& options, ColorizeReport& report) {
  if (options.examples < 1) throw UserError("Examples must be 1 or more; 1 morphs one image-map onto the shape.");
  constexpr double kPatchwork = 0.3;     // discord beyond which one would see where colours come from
  constexpr double kDiscord = 0.2;       // counts as much as the median difference in shape; less hardly matters
  constexpr std::size_t kCompared = 32;  // of the most similar ones
  for (ColorExample& c : all) c.difference = relief_difference(query, c.image, options.centered);
  const auto sort = [&] {
    std::stable_sort(all.begin(), all.end(),
                     [](const ColorExample& a, const ColorExample& b) { return a.difference < b.difference; });
    return std::max(all[all.size() / 2].difference, 1e-12);
  };
  double typical = sort();
  if (!kept.mask.empty()) {
    for (ColorExample& c : all) c.difference += typical * std::pow(discord(c.image, kept, options) / kDiscord, 2);
    typical = sort();
  }
  if (!options.choose.empty()) return;
  if (options.seed != 0) {
    std::mt19937 engine(options.seed);
    std::swap(all[0], all[engine() % unsigned((all.size() + 1) / 2)]);
  }
  all.resize(std::min(all.size(), std::max(kCompared, std::size_t(options.examples))));
  std::vector<std::pair<double, std::size_t>> others;
  for (std::size_t i = 1; i < all.size(); ++i) {
    const double d = discord(all[i].image, all[0].image, options);
    if (d < kPatchwork) others.emplace_back(all[i].difference / typical + std::pow(d / kDiscord, 4), i);
  }
  std::sort(others.begin(), others.end());
  std::vector<ColorExample> chosen;
  chosen.push_back(std::move(all[0]));
  for (const auto& [cost, i] : others)
    if (int(chosen.size()) < options.examples) chosen.push_back(std::move(all[i]));
  report.left_out = std::min(options.examples, int(all.size())) - int(chosen.size());
  all = std::move(chosen);
}

synthesis::SynthesisOptions color_synthesis(const ColorizeOptions& options) {
  synthesis::SynthesisOptions s;
  s.channels = {{kReliefPlane, options.weight_depth, false, true},
                {kReliefPlane, options.weight_detail, true, false},
                {kYPlane, options.weight_y, false, false},
                {kCbPlane, options.weight_cb, false, false},
                {kCrPlane, options.weight_cr, false, false}};
  s.synthesized = {kYPlane, kCbPlane, kCrPlane};
  s.patch_sizes = options.patch_sizes;
  s.position = options.weight_position;
  s.centered = options.centered;
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

std::vector<synthesis::PatchImage> prepare_examples(std::vector<ColorExample> examples, const ColorizeOptions& options,
                                                    ColorizeReport& report) {
  std::vector<synthesis::PatchImage> images;
  for (ColorExample& e : examples) {
    report.used.push_back(e.name);
    if (options.harmonize && !images.empty() && harmonize(e.image, images.front(), options.centered))
      report.harmonized.push_back(report.used.back());
    images.push_back(std::move(e.image));
  }
  return images;
}

void report_synthesis(const synthesis::SynthesisResult& found, const cv::Mat& mask, ColorizeReport& report) {
  report.objective = found.objective;
  const cv::Mat squared = found.distance.mul(found.distance);
  report.patch_distance = std::sqrt(cv::mean(squared, mask)[0]);
  const double foreground = double(cv::countNonZero(found.example >= 0));
  for (std::size_t k = 0; k < report.used.size(); ++k)
    report.shares.push_back(cv::countNonZero(found.example == int(k)) / foreground);
}

}  // namespace parts::colorize
