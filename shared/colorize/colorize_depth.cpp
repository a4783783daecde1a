// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/colorize/colorize_depth.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "parts/base/error.h"
#include "parts/base/median.h"
#include "parts/colorize/color_examples.h"
#include "parts/io/raster_io.h"
#include "parts/render/mask.h"
#include "parts/synthesis/pyramid.h"

namespace parts::colorize {
namespace {

double reach(const cv::Mat& mask) { return std::sqrt(double(cv::countNonZero(mask))); }

/// How the query's pixels map into the examples' frame.
struct Frame {
  cv::Matx23d matrix{1, 0, 0, 0, 1, 0};
  bool moved = false;
};

/// As it is where it lies in the frame like the others; else centroid on
/// centroid, as large as they are.
Frame fit(const cv::Mat& mask, cv::Size frame, double typical_reach, const cv::Point2d& typical_center) {
  const double scale = typical_reach / reach(mask);
  const cv::Point2d center = render::centroid(mask);
  Frame f;
  f.moved =
      mask.size() != frame || scale > 1.25 || scale < 0.8 || cv::norm(center - typical_center) > 0.1 * typical_reach;
  if (f.moved)
    f.matrix = {scale, 0, typical_center.x - scale * center.x, 0, scale, typical_center.y - scale * center.y};
  return f;
}

/// The nearest foreground pixel's source where the frame's mask did not reach.
void fill_sources(ColorizeResult& result) {
  const cv::Mat missing = (result.example < 0) & (result.mask != 0);
  if (cv::countNonZero(missing) == 0) return;
  const cv::Mat nearest = render::nearest_foreground(result.example >= 0);
  for (int y = 0; y < missing.rows; ++y)
    for (int x = 0; x < missing.cols; ++x)
      if (missing.at<uchar>(y, x)) {
        const cv::Point p(nearest.at<cv::Vec2i>(y, x));
        result.example.at<int>(y, x) = result.example.at<int>(p);
        result.source.at<cv::Vec2i>(y, x) = result.source.at<cv::Vec2i>(p);
      }
}

void check_foreground(const cv::Mat& mask) {
  if (cv::countNonZero(mask) < 16)
    throw UserError("The depth map has next to no foreground; 0, NaN and infinity are background.");
}

std::vector<ColorExample> load(examples::ExampleSource& source, const ColorizeOptions& options, Progress& progress) {
  std::vector<std::string> names;
  for (int object = 0; object < source.size(); ++object) names.push_back(source.name(object));
  std::vector<ColorExample> all;
  const std::vector<int> objects = choosable(names, options.choose);
  for (int object : objects) {
    progress.at(double(all.size()) / double(objects.size()));
    all.push_back({object, source.name(object), 0, color_planes(source.get(object, options.view))});
  }
  return all;
}

/// What examples lie in their images like.
struct Typical {
  double reach, relief;  ///< root of the foreground, deviation of the relief to it
  cv::Point2d center;
};
Typical typical(const std::vector<ColorExample>& examples) {
  std::vector<double> reaches, reliefs, xs, ys;
  for (const ColorExample& c : examples) {
    const cv::Point2d center = render::centroid(c.image.mask);
    reaches.push_back(reach(c.image.mask)), xs.push_back(center.x), ys.push_back(center.y);
    reliefs.push_back(relief_spread(c.image) / reaches.back());
  }
  return {median(reaches), median(reliefs), {median(xs), median(ys)}};
}

/// The depth in the examples' frame, its relief as strong as theirs.
synthesis::PatchImage query_of(const cv::Mat& depth, const cv::Mat& mask, const Frame& frame, cv::Size size,
                               double strength) {
  synthesis::PatchImage query;
  query.planes.resize(4);
  query.mask = mask.clone();  // result.mask stays as it is
  cv::Mat full = synthesis::extend(relief(depth, mask, 1), mask);
  if (frame.moved) {
    cv::warpAffine(full, full, frame.matrix, size, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::warpAffine(mask, query.mask, frame.matrix, size, cv::INTER_LINEAR);
    query.mask = query.mask >= 128;
    check_foreground(query.mask);
  }
  query.planes[kReliefPlane] = full;
  const double spread = relief_spread(query);
  if (spread > 0) full *= strength * reach(query.mask) / spread;
  full.setTo(0, query.mask == 0);
  return query;
}

/// Brings what was found in the examples' frame back into that of the depth.
void bring_back(const Frame& frame, const cv::Mat& mask, std::vector<cv::Mat>& planes, ColorizeResult& result) {
  const cv::Size size = result.mask.size();
  const auto back = [&](const cv::Mat& from, int interpolation) {
    cv::Mat to;
    cv::warpAffine(from, to, frame.matrix, size, interpolation | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    return to;
  };
  for (cv::Mat& plane : planes) plane = back(synthesis::extend(plane, mask), cv::INTER_CUBIC);
  cv::Mat index, pixel;
  result.example.convertTo(index, CV_32F);
  result.source.convertTo(pixel, CV_32F);
  back(index, cv::INTER_NEAREST).convertTo(result.example, CV_32S);
  back(pixel, cv::INTER_NEAREST).convertTo(result.source, CV_32S);
  result.example.setTo(-1, result.mask == 0);
  fill_sources(result);
}

}  // namespace

ColorizeResult colorize_depth(const cv::Mat& depth, examples::ExampleSource& source, const ColorizeOptions& options,
                              Progress& progress) {
  ColorizeResult result;
  result.mask = io::depth_mask(depth);
  check_foreground(result.mask);
  progress.stage("Reading examples", 0, 20);
  std::vector<ColorExample> examples = load(source, options, progress);
  const Typical like = typical(examples);
  const Frame frame = fit(result.mask, source.image_size(), like.reach, like.center);
  result.aligned = frame.moved;
  const synthesis::PatchImage query = query_of(depth, result.mask, frame, source.image_size(), like.relief);
  select_examples(examples, query, {}, options, result);
  const std::vector<synthesis::PatchImage> images = prepare_examples(std::move(examples), options, result);

  Progress rest = progress.part(20, 100);
  const synthesis::SynthesisResult found = synthesis::synthesize(query, images, color_synthesis(options), {}, rest);
  report_synthesis(found, query.mask, result);
  result.example = found.example, result.source = found.source;
  std::vector<cv::Mat> planes = found.planes;
  if (frame.moved) bring_back(frame, query.mask, planes, result);
  result.color = to_color(planes);
  result.color.setTo(0, result.mask == 0);
  result.example.setTo(-1, result.mask == 0);
  return result;
}

}  // namespace parts::colorize
