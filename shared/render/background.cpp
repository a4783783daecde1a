// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/background.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

#include "parts/base/error.h"

namespace parts::render {
namespace {

constexpr double kLeastShare = 1e-3;  // of the pixels, for a plateau
constexpr long kLeastPixels = 16;
constexpr double kRounding = 1e-6;  // relative
constexpr double kFlatShare = 0.5;  // of the other pixels with one depth: then all is flat here
constexpr double kMarker = 4;       // so many times as far as the others again, it is no wall even then
constexpr double kNearlyAll = 0.8;  // of the others; filtered rasters have pixels in between
constexpr double kStep = 0.5;       // at the plateau's rim: of what lies between it and nearly all others
constexpr double kAway = 0.7;       // of the rim; elsewhere the way may run along what lies in between
constexpr double kJump = 0.25;      // between the others and the plateau: of the others' range, at least

/// The same number, but for how filters and units round it.
bool is(float z, float plateau) { return std::abs(double(z) - plateau) <= kRounding * std::abs(double(plateau)); }

cv::Mat where(const cv::Mat& depth, float plateau) {
  cv::Mat found(depth.size(), CV_8U);
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) found.at<uchar>(y, x) = is(depth.at<float>(y, x), plateau) ? 255 : 0;
  return found;
}

/// The other depths, sorted.
std::vector<float> depths_before(const cv::Mat& depth, float plateau) {
  std::vector<float> list;
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x)
      if (const float z = depth.at<float>(y, x); z < plateau && !is(z, plateau)) list.push_back(z);
  std::sort(list.begin(), list.end());
  return list;
}

long most_of_one(const std::vector<float>& sorted) {
  long most = 0;
  for (auto from = sorted.begin(); from != sorted.end();) {
    const auto to = std::upper_bound(from, sorted.end(), *from);
    most = std::max(most, long(to - from));
    from = to;
  }
  return most;
}

/// Whether a plateau lies by at least a step behind what is a few pixels beyond
/// most of its rim. (Filtered rasters have pixels in between.)
bool lies_behind(const cv::Mat& depth, float plateau, double step) {
  constexpr int reach = 3;
  const cv::Rect frame({0, 0}, depth.size());
  long rim = 0, away = 0;
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      if (!is(depth.at<float>(y, x), plateau)) continue;
      for (const cv::Point& way : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
        const cv::Point beside = cv::Point(x, y) + way, beyond = cv::Point(x, y) + way * reach;
        if (!frame.contains(beyond)) continue;
        const float b = depth.at<float>(beside), z = depth.at<float>(beyond);
        if (std::isnan(b) || is(b, plateau) || std::isnan(z) || is(z, plateau)) continue;
        ++rim, away += plateau - z >= step;
      }
    }
  return double(away) >= kAway * double(rim);
}

}  // namespace

std::optional<float> find_background(const cv::Mat& depth) {
  const cv::Mat known = depth == depth;
  const int pixels = cv::countNonZero(known);
  if (pixels == 0) return {};
  double largest = 0;
  cv::minMaxLoc(depth, nullptr, &largest, nullptr, nullptr, known);
  const float value = float(largest);
  const cv::Mat plateau = where(depth, value);
  if (cv::countNonZero(plateau) < std::max(double(kLeastPixels), kLeastShare * double(depth.total()))) return {};
  cv::Mat border = cv::Mat::zeros(depth.size(), CV_8U);
  border.row(0).setTo(255), border.row(border.rows - 1).setTo(255);
  border.col(0).setTo(255), border.col(border.cols - 1).setTo(255);
  if (cv::countNonZero(plateau & border) == 0) return {};

  const std::vector<float> others = depths_before(depth, value);
  if (others.empty()) return {};
  const double front = others.front(), back = others[std::size_t(kNearlyAll * double(others.size() - 1))];
  if (!(value - back >= kJump * (back - front))) return {};
  const bool flat = double(most_of_one(others)) > kFlatShare * double(others.size());
  if (flat && !(value - back > kMarker * std::abs(back))) return {};
  return lies_behind(depth, value, kStep * (value - back)) ? std::optional(value) : std::nullopt;
}

BackgroundRule parse_background(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t"), end = text.find_last_not_of(" \t");
  const std::string word = begin == text.npos ? "" : text.substr(begin, end - begin + 1);
  if (word.empty() || word == "auto") return {};
  if (word == "none") return {false, {}};
  double value = 0;
  const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || rest != word.data() + word.size() || !std::isfinite(value))
    throw UserError("The background \"" + text + "\" is no depth; give a number, auto or none.");
  return {false, value};
}

RemovedBackground remove_background(const BackgroundRule& rule, double scale, cv::Mat& depth, cv::Mat& back) {
  std::optional<float> value;
  if (rule.automatic) value = find_background(depth);
  if (rule.value) value = float(*rule.value * scale);
  if (!value) return {};
  const auto remove = [&](cv::Mat& raster) {
    const cv::Mat found = where(raster, *value);
    raster.setTo(std::numeric_limits<float>::quiet_NaN(), found);
    return cv::countNonZero(found);
  };
  RemovedBackground removed{*value / scale, remove(depth)};
  if (!back.empty()) remove(back);
  if (cv::countNonZero(depth == depth) == 0)
    throw UserError("All of the depth raster is Background; give another value, or none.");
  return removed;
}

}  // namespace parts::render
