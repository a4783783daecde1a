// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/leave_one_out.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "bench/measure.h"
#include "parts/depth/alignment.h"
#include "parts/depth/gallery.h"
#include "parts/examples/examples.h"
#include "parts/render/mask.h"
#include "parts/synthesis/pyramid.h"

namespace parts::bench {

std::unique_ptr<examples::ExampleSource> open_class(const std::string& name, int width, int height) {
  Progress progress;
  examples::ExampleOptions options;
  options.width = width, options.height = height;
  return examples::open_examples(std::string(PARTS_DATA) + "/" + name, {{0, 0}}, options, progress);
}

namespace {

cv::Vec3f normal(const cv::Mat& d, int x, int y) {
  const cv::Vec3f n((d.at<float>(y, x + 1) - d.at<float>(y, x - 1)) / 2,
                    (d.at<float>(y + 1, x) - d.at<float>(y - 1, x)) / 2, 1);
  return n / cv::norm(n);
}

/// Both in pixels, over the mask: after aligning the offset, and the scale too;
/// and the mean angle between normals.
/// Root mean square of the Laplacian of depth in pixels, at most one a pixel: jumps are no roughness.
double roughness(const cv::Mat& depth, const cv::Mat& mask) {
  cv::Mat inside, laplacian;
  cv::erode(mask, inside, cv::Mat::ones(9, 9, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT, 0);
  cv::Laplacian(synthesis::extend(depth, mask), laplacian, CV_32F);
  laplacian = cv::min(cv::max(laplacian, -1), 1);
  return std::sqrt(cv::mean(laplacian.mul(laplacian), inside)[0]);
}

Error compare(const cv::Mat& depth, const cv::Mat& truth, const cv::Mat& mask) {
  double low, high, n = 0, sd = 0, st = 0, sdd = 0, sdt = 0, stt = 0, angle = 0, normals = 0;
  cv::minMaxLoc(truth, &low, &high, nullptr, nullptr, mask);
  const auto in = [&](int x, int y) { return mask.at<uchar>(y, x) != 0; };
  for (int y = 1; y + 1 < mask.rows; ++y)
    for (int x = 1; x + 1 < mask.cols; ++x) {
      if (!in(x, y)) continue;
      const double d = depth.at<float>(y, x), t = truth.at<float>(y, x);
      ++n, sd += d, st += t, sdd += d * d, sdt += d * t, stt += t * t;
      if (!in(x - 1, y) || !in(x + 1, y) || !in(x, y - 1) || !in(x, y + 1)) continue;
      ++normals, angle += std::acos(std::min(1.f, normal(depth, x, y).dot(normal(truth, x, y))));
    }
  const double vd = sdd - sd * sd / n, vt = stt - st * st / n, c = sdt - sd * st / n, s = vd > 0 ? c / vd : 0;
  return {std::sqrt(std::max(0., vd + vt - 2 * c) / n) / (high - low),
          std::sqrt(std::max(0., vt - 2 * s * c + s * s * vd) / n) / (high - low), angle / normals * 180 / CV_PI,
          roughness(depth, mask) / std::max(1e-9, roughness(truth, mask))};
}

/// An example's depth, moved so that its centroid lies on the query's; where the
/// images differ in size, as large as the query too.
cv::Mat moved(const cv::Mat& depth, const examples::Example& e, const examples::Example& query) {
  const cv::Point2d from = render::centroid(e.mask), to = render::centroid(query.mask);
  const double scale = e.mask.size() == query.mask.size()
                           ? 1
                           : std::sqrt(double(cv::countNonZero(query.mask)) / cv::countNonZero(e.mask));
  const cv::Mat full = synthesis::extend(depth, e.mask);
  cv::Mat result(query.mask.size(), CV_32F);
  for (int y = 0; y < result.rows; ++y)
    for (int x = 0; x < result.cols; ++x)
      result.at<float>(y, x) =
          float(scale * full.at<float>(std::clamp(int(std::lround((y - to.y) / scale + from.y)), 0, full.rows - 1),
                                       std::clamp(int(std::lround((x - to.x) / scale + from.x)), 0, full.cols - 1)));
  return result;
}

}  // namespace

depth::DepthResult compare_with_others(examples::ExampleSource& others, const examples::Example& q,
                                       const render::View& view, const depth::DepthOptions& options, double share,
                                       Score& score) {
  Progress quiet;
  const Stopwatch watch;
  const depth::DepthResult r = depth::reconstruct_depth({q.image, q.mask}, others, options, quiet);
  score.wall += watch.wall() * share, score.cpu += watch.cpu() * share;

  const double scale = q.camera.scale;
  const synthesis::PatchImage look{{depth::intensity(q.image)}, q.mask};
  cv::Mat mean = cv::Mat::zeros(q.depth.size(), CV_32F), back = mean.clone(), nearest;
  double least = 1e30;
  for (int i = 0; i < others.size(); ++i) {
    const examples::Example e = others.get(i, view);
    const double middle = cv::mean(e.depth, e.mask)[0];
    const cv::Mat depth = moved((e.depth - middle) * e.camera.scale, e, q);
    mean += depth / others.size();
    if (!e.back_depth.empty()) back += moved((e.back_depth - middle) * e.camera.scale, e, q) / others.size();
    const double d = depth::image_difference(look, {{depth::intensity(e.image)}, e.mask});
    if (d < least) least = d, nearest = depth;
  }
  score.ours.add(compare(r.depth * r.camera.scale, q.depth * scale, q.mask), share);
  score.mean.add(compare(mean, q.depth * scale, q.mask), share);
  score.nearest.add(compare(nearest, q.depth * scale, q.mask), share);
  if (options.back) {
    score.back.add(compare(r.back_depth * r.camera.scale, q.back_depth * scale, q.mask), share);
    score.back_mean.add(compare(back, q.back_depth * scale, q.mask), share);
  }
  const double away = render::angle_between(r.view, view);
  score.angle += away * share;
  score.found += away <= 5;
  ++score.count;
  return r;
}

void measure(examples::ExampleSource& all, int k, const render::View& view, const depth::DepthOptions& options,
             double share, Score& score, examples::ExampleSource* queries) {
  Others others(all, k);
  compare_with_others(others, (queries ? *queries : all).get(k, view), view, options, share, score);
}

}  // namespace parts::bench
