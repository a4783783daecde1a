// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/synthesis/patches.h"

#include <algorithm>
#include <cmath>

namespace parts::synthesis {
namespace {

// Variance added before windows are normalised, as a share of the image's own:
// noise in flat windows stays small.
constexpr float flat = 0.01f;

Lane image_variance(PatchPlane& plane, const cv::Mat& coverage, int lane) {
  Eigen::Array4d sum = Eigen::Array4d::Zero(), squares = sum;
  double total = 0;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) {
      const double w = coverage.at<float>(y, x);
      const Eigen::Array4d v = plane.at(x, y)[lane].cast<double>();
      sum += w * v, squares += w * v * v, total += w;
    }
  return (squares / total - (sum / total).square()).max(1e-30).cast<float>();
}

}  // namespace

void update_statistics(PatchPlane& plane, const cv::Mat& coverage, const PatchLayout& layout) {
  const int r = layout.radius();
  const long n = long(plane.width) * plane.height;
  plane.scale.assign(n * plane.lanes, Lane::Ones());
  plane.offset.assign(n * plane.lanes, Lane::Zero());
  for (int lane = 0; lane < plane.lanes; ++lane) {
    if ((layout.normalized[lane] == 0).all()) continue;
    const Lane floor = image_variance(plane, coverage, lane) * flat;
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) {
        if (!plane.inside[plane.index(x, y)]) continue;
        Lane sum = Lane::Zero(), squares = Lane::Zero();
        float total = 0;
        for (int j = -r; j <= r; ++j)
          for (int i = -r; i <= r; ++i) {
            const int u = x + i, v = y + j;
            if (u < 0 || v < 0 || u >= plane.width || v >= plane.height) continue;
            const float w = layout.gaussian[(j + r) * layout.side + i + r] * coverage.at<float>(v, u);
            const Lane value = plane.at(u, v)[lane];
            sum += w * value, squares += w * value * value, total += w;
          }
        const Lane mean = sum / total, variance = (squares / total - mean * mean).max(0);
        const Lane scale = layout.factor[lane] / (variance + floor).sqrt();
        const long at = plane.index(x, y) * plane.lanes + lane;
        plane.scale[at] = layout.normalized[lane] * scale + (1 - layout.normalized[lane]);
        plane.offset[at] = -layout.normalized[lane] * mean * scale;
      }
  }
}

PatchPlane outline(const cv::Mat& coverage) {
  PatchPlane plane;
  plane.width = coverage.cols, plane.height = coverage.rows;
  plane.inside.reserve(coverage.total());
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) plane.inside.push_back(coverage.at<float>(y, x) >= 0.5f);
  return plane;
}

PatchPlane make_patch_plane(const std::vector<cv::Mat>& channels, const cv::Mat& coverage, const PatchLayout& layout) {
  PatchPlane plane;
  plane.width = coverage.cols, plane.height = coverage.rows;
  plane.border = layout.radius(), plane.lanes = layout.lanes;
  plane.data.assign(long(plane.height + 2 * plane.border) * plane.stride(), Lane::Zero());
  plane.inside.assign(long(plane.width) * plane.height, 0);
  double mass = 0, cx = 0, cy = 0;
  for (int y = -plane.border; y < plane.height + plane.border; ++y)
    for (int x = -plane.border; x < plane.width + plane.border; ++x) {
      const int u = std::clamp(x, 0, plane.width - 1), v = std::clamp(y, 0, plane.height - 1);
      Lane* to = plane.at(x, y);
      for (size_t c = 0; c < channels.size(); ++c)
        if (!channels[c].empty()) to[c / 4][c % 4] = channels[c].at<float>(v, u);
      if (u != x || v != y) continue;
      const double m = coverage.at<float>(y, x);
      mass += m, cx += m * x, cy += m * y;
      plane.inside[plane.index(x, y)] = m >= 0.5;
    }
  if (mass > 0) plane.centroid = {float(cx / mass), float(cy / mass)};
  update_statistics(plane, coverage, layout);
  return plane;
}

void gather(const PatchPlane& plane, const cv::Mat& coverage, int x, int y, const PatchLayout& layout, Window& window) {
  const int r = layout.radius();
  const long at = plane.index(x, y) * plane.lanes;
  window.value.resize(layout.window());
  window.weight.resize(layout.window());
  Lane* value = window.value.data();
  Lane* weight = window.weight.data();
  for (int j = -r; j <= r; ++j)
    for (int i = -r; i <= r; ++i) {
      const int u = std::clamp(x + i, 0, plane.width - 1), v = std::clamp(y + j, 0, plane.height - 1);
      const float g = layout.gaussian[(j + r) * layout.side + i + r];
      const float m = coverage.at<float>(v, u) * (u == x + i && v == y + j);
      const Lane* from = plane.corner(x + i + plane.border, y + j + plane.border);
      for (int lane = 0; lane < plane.lanes; ++lane) {
        *value++ = from[lane] * plane.scale[at + lane] + plane.offset[at + lane];
        *weight++ = g * layout.active[lane] * (m + (1 - m) * layout.everywhere[lane]);
      }
    }
  window.position = (Eigen::Vector2f(x, y) - plane.centroid) * layout.position;
}

namespace {

template <int lanes>
float compare(const Window& window, const PatchPlane& plane, int x, int y, const PatchLayout& layout, float enough) {
  const long at = plane.index(x, y) * lanes;
  Lane scale[lanes], offset[lanes];
  for (int k = 0; k < lanes; ++k) scale[k] = plane.scale[at + k], offset[k] = plane.offset[at + k];
  const Lane* value = window.value.data();
  const Lane* weight = window.weight.data();
  const Eigen::Vector2f position = (Eigen::Vector2f(x, y) - plane.centroid) * layout.position;
  const float far = (position - window.position).squaredNorm();
  if (far >= enough) return far;
  Lane sum = Lane::Zero();
  for (int j = 0; j < layout.side; ++j) {
    const Lane* from = plane.corner(x, y + j);
    for (int i = 0; i < layout.side; ++i)
      for (int k = 0; k < lanes; ++k) {
        const Lane d = *from++ * scale[k] + offset[k] - *value++;
        sum += *weight++ * d * d;
      }
    if ((j & 1) && far + sum.sum() >= enough) break;
  }
  return far + sum.sum();
}

}  // namespace

float distance(const Window& window, const PatchPlane& plane, int x, int y, const PatchLayout& layout, float enough) {
  switch (layout.lanes) {
    case 1:
      return compare<1>(window, plane, x, y, layout, enough);
    case 2:
      return compare<2>(window, plane, x, y, layout, enough);
    default:
      return compare<3>(window, plane, x, y, layout, enough);
  }
}

}  // namespace parts::synthesis
