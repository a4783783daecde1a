// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/depth/alignment.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "parts/render/mask.h"
#include "parts/synthesis/pyramid.h"

namespace parts::depth {

cv::Matx23d Placement::matrix() const {
  const double a = scale * std::cos(rotation * CV_PI / 180), b = scale * std::sin(rotation * CV_PI / 180);
  // Rows grow downwards: anticlockwise is (x, y) -> (x cos + y sin, -x sin + y cos).
  return {a, b, to.x - a * from.x - b * from.y, -b, a, to.y + b * from.x - a * from.y};
}

cv::Matx23d Placement::inverse() const {
  Placement back;
  back.scale = 1 / scale, back.rotation = -rotation, back.from = to, back.to = from;
  return back.matrix();
}

namespace {

// Pixels' centres are whole numbers for warpAffine and halves are lost in
// resizing: shrinks by area first, then warps what is left.
cv::Mat warp(const cv::Mat& image, const cv::Matx23d& matrix, double scale, cv::Size frame, int border) {
  cv::Mat from = image;
  cv::Matx23d m = matrix;
  if (scale < 0.75) {
    const cv::Size small(std::max(1, int(std::lround(image.cols * scale))),
                         std::max(1, int(std::lround(image.rows * scale))));
    cv::resize(image, from, small, 0, 0, cv::INTER_AREA);
    const double sx = double(image.cols) / small.width, sy = double(image.rows) / small.height;
    // small (x, y) is the image's ((x + 1/2) sx - 1/2, ...)
    m(0, 2) += m(0, 0) * (sx - 1) / 2 + m(0, 1) * (sy - 1) / 2;
    m(1, 2) += m(1, 0) * (sx - 1) / 2 + m(1, 1) * (sy - 1) / 2;
    m(0, 0) *= sx, m(1, 0) *= sx, m(0, 1) *= sy, m(1, 1) *= sy;
  }
  cv::Mat result;
  cv::warpAffine(from, result, m, frame, cv::INTER_LINEAR, border);
  return result;
}

bool is_identity(const Placement& p, cv::Size from, cv::Size frame) {
  return p.scale == 1 && p.rotation == 0 && from == frame && p.from == p.to;
}

// What is searched with: a small copy of the query, which placements refer to
// the large one.
struct Small {
  cv::Mat grey, coverage;  ///< 32F, extended; 32F
  double shrink = 1;       ///< pixels of the query a pixel here
  cv::Point2d center;
  double area = 0;  ///< pixels of the query
};

Small shrink(const DepthQuery& query, int longest) {
  Small s;
  const cv::Mat grey = synthesis::extend(intensity(query.color), query.mask);
  cv::Mat coverage;
  cv::Mat(query.mask != 0).convertTo(coverage, CV_32F, 1 / 255.);
  s.shrink = std::max(1., std::max(grey.cols, grey.rows) / double(longest));
  const cv::Size size(std::max(1, int(grey.cols / s.shrink)), std::max(1, int(grey.rows / s.shrink)));
  cv::resize(grey, s.grey, size, 0, 0, cv::INTER_AREA);
  cv::resize(coverage, s.coverage, size, 0, 0, cv::INTER_AREA);
  s.center = render::centroid(query.mask);
  s.area = cv::countNonZero(query.mask);
  return s;
}

synthesis::PatchImage place_small(const Small& small, const Placement& p, cv::Size frame, double frame_shrink) {
  Placement q = p;
  q.scale *= small.shrink / frame_shrink;
  q.from = p.from / small.shrink, q.to = p.to / frame_shrink;
  synthesis::PatchImage image;
  image.planes = {warp(small.grey, q.matrix(), q.scale, frame, cv::BORDER_REPLICATE)};
  image.mask = warp(small.coverage, q.matrix(), q.scale, frame, cv::BORDER_CONSTANT) >= 0.5f;
  return image;
}

}  // namespace

synthesis::PatchImage place(const DepthQuery& query, const Placement& placement, cv::Size frame) {
  synthesis::PatchImage image;
  const cv::Mat grey = intensity(query.color);
  if (is_identity(placement, query.color.size(), frame)) {
    image.planes = {grey};
    image.mask = query.mask;
    return image;
  }
  cv::Mat coverage;
  cv::Mat(query.mask != 0).convertTo(coverage, CV_32F, 1 / 255.);
  image.planes = {
      warp(synthesis::extend(grey, query.mask), placement.matrix(), placement.scale, frame, cv::BORDER_REPLICATE)};
  image.mask = warp(coverage, placement.matrix(), placement.scale, frame, cv::BORDER_CONSTANT) >= 0.5f;
  return image;
}

double image_difference(const synthesis::PatchImage& a, const synthesis::PatchImage& b) {
  const cv::Point2d shift = render::centroid(a.mask) - render::centroid(b.mask);
  const int dx = int(std::lround(shift.x)), dy = int(std::lround(shift.y));
  const auto at = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < b.mask.cols && y < b.mask.rows && b.mask.at<uchar>(y, x);
  };
  double both = 0, only = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (int y = 0; y < a.mask.rows; ++y)
    for (int x = 0; x < a.mask.cols; ++x) {
      const bool in = a.mask.at<uchar>(y, x) != 0;
      if (in != at(x - dx, y - dy)) ++only;
      if (!in || !at(x - dx, y - dy)) continue;
      const double u = a.planes[0].at<float>(y, x), v = b.planes[0].at<float>(y - dy, x - dx);
      ++both, sa += u, sb += v, saa += u * u, sbb += v * v, sab += u * v;
    }
  if (both < 1) return 1e9;
  const double va = saa / both - sa / both * (sa / both), vb = sbb / both - sb / both * (sb / both);
  const double correlation = va > 1e-12 && vb > 1e-12 ? (sab / both - sa / both * (sb / both)) / std::sqrt(va * vb) : 0;
  return 2 * (1 - correlation) + 4 * only / both;
}

Placement fit_query(const DepthQuery& query, cv::Size frame) {
  const cv::Size size = query.color.size();
  Placement p;
  p.scale = std::min(double(frame.width) / size.width, double(frame.height) / size.height);
  p.from = {(size.width - 1) / 2., (size.height - 1) / 2.};
  p.to = {(frame.width - 1) / 2., (frame.height - 1) / 2.};
  return p;
}

Placement align_query(const DepthQuery& query, Gallery& gallery, const DepthOptions& options) {
  // Objects from the views that the query may be seen from.
  std::vector<render::View> views = options.views;
  if (!gallery.has_any_view()) views = gallery.stored_views();
  if (options.update_views && gallery.has_any_view())
    for (const render::View& v : options.views)
      for (int i = -1; i <= 1; i += 2)
        views.push_back({v.yaw + 25 * i, v.pitch}), views.push_back({v.yaw, v.pitch + 18 * i});
  const int objects = std::min(6, gallery.size());
  std::vector<const synthesis::PatchImage*> examples;
  double area = 0;
  for (int i = 0; i < objects; ++i)
    for (const render::View& v : views) {
      examples.push_back(&gallery.small(i * gallery.size() / objects, v));
      area += cv::countNonZero(examples.back()->mask);
    }
  const cv::Size frame = gallery.image_size(), small_frame = examples.front()->mask.size();
  const double frame_shrink = std::pow(2., std::round(std::log2(double(frame.width) / small_frame.width)));
  area *= frame_shrink * frame_shrink / double(examples.size());
  const Small small = shrink(query, 2 * Gallery::thumbnail_size);

  const auto misfit = [&](const Placement& p) {
    const synthesis::PatchImage image = place_small(small, p, small_frame, frame_shrink);
    if (cv::countNonZero(image.mask) < 8) return 1e9;
    double least = 1e9;
    for (const synthesis::PatchImage* e : examples) least = std::min(least, image_difference(image, *e));
    return least;
  };
  Placement plain = fit_query(query, frame);
  const double plain_misfit = misfit(plain);

  Placement best;
  best.from = small.center;
  best.to = {(frame.width - 1) / 2., (frame.height - 1) / 2.};
  const double first = std::sqrt(area / small.area);
  double least = 1e9;
  for (int i = -4; i <= 4; ++i)
    for (int j = -2; j <= 2; ++j) {
      Placement p = best;
      p.scale = first * std::pow(1.12, j), p.rotation = 10 * i;
      const double m = misfit(p) * (1 + 0.02 * std::abs(i));
      if (m < least) least = m, best = p;
    }
  for (double step : {0.5, 0.25}) {
    const Placement center = best;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        Placement p = center;
        p.scale *= std::pow(1.12, j * step), p.rotation += 10 * i * step;
        const double m = misfit(p);
        if (m < least) least = m, best = p;
      }
  }
  return least < 0.85 * plain_misfit ? best : plain;
}

}  // namespace parts::depth
