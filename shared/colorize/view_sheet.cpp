// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/colorize/view_sheet.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "parts/base/parallel.h"

namespace parts::colorize {
namespace {

constexpr float kFeather = 4;       // pixels beside a silhouette or a jump that are trusted less
constexpr double kTolerance = 1.5;  // pixels in depth that two views of one point may differ, more on slopes
constexpr double kSteepest = 4;     // a slope beyond which it grows no more

/// Depth between neighbours beyond which they are not one surface.
bool jump(float a, float b, double pixel) { return !(std::abs(a - b) < 4 * pixel); }

cv::Mat normals(const examples::Example& view) {
  cv::Mat out(view.depth.size(), CV_32FC3, cv::Scalar::all(0));
  const double pixel = 1 / view.pixels_per_unit();
  const auto slope = [&](float before, float at, float after) {
    const bool left = !jump(before, at, pixel), right = !jump(after, at, pixel);
    if (left && right) return (after - before) / 2;
    return left ? at - before : right ? after - at : 0.f;
  };
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      if (!view.mask.at<uchar>(y, x)) continue;
      const auto depth = [&](int v, int u) {
        return v < 0 || u < 0 || v >= out.rows || u >= out.cols ? std::nanf("") : view.depth.at<float>(v, u);
      };
      const float at = depth(y, x);
      const Vec3 n(slope(depth(y, x - 1), at, depth(y, x + 1)), -slope(depth(y - 1, x), at, depth(y + 1, x)), pixel);
      const Vec3 world = view.camera.rotation.transpose() * n.normalized();
      out.at<cv::Vec3f>(y, x) = {float(world.x()), float(world.y()), float(world.z())};
    }
  return out;
}

cv::Mat trust(const examples::Example& view) {
  const double pixel = 1 / view.pixels_per_unit();
  cv::Mat smooth = view.mask.clone(), distance, out;
  for (int y = 0; y < smooth.rows; ++y)
    for (int x = 0; x < smooth.cols; ++x) {
      const float at = view.depth.at<float>(y, x);
      if ((x + 1 < smooth.cols && jump(at, view.depth.at<float>(y, x + 1), pixel)) ||
          (y + 1 < smooth.rows && jump(at, view.depth.at<float>(y + 1, x), pixel)) || x == 0 || y == 0)
        smooth.at<uchar>(y, x) = 0;
    }
  cv::distanceTransform(smooth, distance, cv::DIST_L2, 3);
  distance.convertTo(out, CV_32F, 1 / kFeather);
  out = cv::min(cv::max(out, 0.05f), 1.f);
  out.setTo(0, view.mask == 0);
  return out;
}

int round_up(int value, int step) { return (value + step - 1) / step * step; }

/// Bilinear, within a rectangle of the plane.
float sample(const cv::Mat& plane, double x, double y, const cv::Rect& within) {
  const double u = std::clamp(x, double(within.x), within.x + within.width - 1.);
  const double v = std::clamp(y, double(within.y), within.y + within.height - 1.);
  const int u0 = int(u), v0 = int(v);
  const int u1 = std::min(u0 + 1, within.x + within.width - 1), v1 = std::min(v0 + 1, within.y + within.height - 1);
  const float a = float(u - u0), b = float(v - v0);
  return (1 - b) * ((1 - a) * plane.at<float>(v0, u0) + a * plane.at<float>(v0, u1)) +
         b * ((1 - a) * plane.at<float>(v1, u0) + a * plane.at<float>(v1, u1));
}

}  // namespace

ViewSheet::ViewSheet(const std::vector<examples::Example>& views, const std::vector<cv::Rect>& parts, int levels,
                     int gap, int threads)
    : threads_(threads) {
  const int step = 1 << (levels - 1);
  int x = 0, height = 0;
  for (std::size_t k = 0; k < views.size(); ++k) {
    tiles_.push_back({views[k].camera, views[k].depth, normals(views[k]), trust(views[k]), parts[k], {x, 0}});
    x = round_up(x + parts[k].width, step) + gap * step;
    height = std::max(height, parts[k].height);
  }
  size_ = {std::max(1, x - gap * step), height};
}

synthesis::PatchImage ViewSheet::assemble(const std::vector<synthesis::PatchImage>& images) const {
  synthesis::PatchImage sheet;
  sheet.mask = cv::Mat::zeros(size_, CV_8U);
  for (const cv::Mat& plane : images.front().planes)
    sheet.planes.push_back(plane.empty() ? cv::Mat() : cv::Mat(cv::Mat::zeros(size_, CV_32F)));
  for (std::size_t k = 0; k < tiles_.size(); ++k) {
    const cv::Rect to(tiles_[k].place, tiles_[k].part.size());
    images[k].mask(tiles_[k].part).copyTo(sheet.mask(to));
    for (std::size_t p = 0; p < sheet.planes.size(); ++p)
      if (!sheet.planes[p].empty()) images[k].planes[p](tiles_[k].part).copyTo(sheet.planes[p](to));
  }
  return sheet;
}

float ViewSheet::look(const std::vector<cv::Mat>& planes, int level, const Vec3& point, const Vec3& normal,
                      float* value) const {
  float total = 0;
  float sum[8] = {};
  const int n = std::min(int(planes.size()), 8);
  for (const Tile& tile : tiles_) {
    const Vec3 towards = tile.camera.rotation.row(2);
    if (normal.dot(towards) < -0.2) continue;
    const Vec3 q = tile.camera.project(point);
    const double x = q.x() - 0.5, y = q.y() - 0.5;  // of pixels' centres
    if (!(std::abs(x) < 1e6 && std::abs(y) < 1e6)) continue;
    const int column = int(std::lround(x)), row = int(std::lround(y));
    if (!tile.part.contains({column, row})) continue;
    const float depth = tile.depth.at<float>(row, column);
    if (std::isnan(depth)) continue;
    const cv::Vec3f& m = tile.normal.at<cv::Vec3f>(row, column);
    const double facing = std::max(0.05, towards.dot(Vec3(m[0], m[1], m[2])));
    const double slope = std::min(std::sqrt(std::max(0., 1 - facing * facing)) / facing, kSteepest);
    if (std::abs(q.z() - depth) * tile.camera.scale > kTolerance * (1 + slope)) continue;
    const float weight = float(facing * facing * facing) * tile.trust.at<float>(row, column);
    const double scale = 1.0 / (1 << level);
    const cv::Point first = tile.place / (1 << level);
    const cv::Rect within(first.x, first.y, std::max(1, int((tile.part.width - 1) * scale) + 1),
                          std::max(1, int((tile.part.height - 1) * scale) + 1));
    for (int k = 0; k < n; ++k)
      sum[k] += weight * sample(planes[k], (x - tile.part.x) * scale + first.x, (y - tile.part.y) * scale + first.y,
                                within & cv::Rect({0, 0}, planes[k].size()));
    total += weight;
  }
  if (total > 0)
    for (int k = 0; k < n; ++k) value[k] = sum[k] / total;
  return total;
}

void ViewSheet::agree(int level, std::vector<cv::Mat>& planes) const {
  std::vector<cv::Mat> agreed;
  for (const cv::Mat& plane : planes) agreed.push_back(plane.clone());
  for (const Tile& tile : tiles_) {
    const int width = (tile.part.width - 1) / (1 << level) + 1, height = (tile.part.height - 1) / (1 << level) + 1;
    const cv::Point first = tile.place / (1 << level);
    parallel_for(height, threads_, [&](long begin, long end) {
      std::vector<float> value(planes.size());
      for (int y = int(begin); y < end; ++y)
        for (int x = 0; x < width; ++x) {
          const int column = tile.part.x + (x << level), row = tile.part.y + (y << level);
          const float depth = tile.depth.at<float>(row, column);
          if (std::isnan(depth)) continue;
          const cv::Vec3f& m = tile.normal.at<cv::Vec3f>(row, column);
          const Vec3 point = tile.camera.unproject(column + 0.5, row + 0.5, depth);
          if (look(planes, level, point, Vec3(m[0], m[1], m[2]), value.data()) <= 0) continue;
          for (std::size_t k = 0; k < planes.size(); ++k) agreed[k].at<float>(first.y + y, first.x + x) = value[k];
        }
    });
  }
  planes = std::move(agreed);
}

}  // namespace parts::colorize
