// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/depth/reconstruct_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "parts/base/error.h"
#include "parts/depth/alignment.h"
#include "parts/depth/example_set.h"
#include "parts/depth/light_search.h"
#include "parts/depth/segment.h"
#include "parts/depth/trust.h"
#include "parts/depth/view_search.h"
#include "parts/synthesis/pyramid.h"

namespace parts::depth {
namespace {

constexpr double same_view = 5;  ///< degrees: nearer than this, a view in use does as well

void check_image(const cv::Mat& color) {
  if (color.empty() || color.type() != CV_8UC3)
    throw UserError("The image is empty or not a colour image of 8 bits; choose another.");
  if (std::min(color.rows, color.cols) < 16)
    throw UserError("The image has only " + std::to_string(color.cols) + " x " + std::to_string(color.rows) +
                    " pixels; give one of at least 16 x 16.");
}

void check(const DepthQuery& query, const DepthOptions& options) {
  if (!query.mask.empty() && query.mask.size() != query.color.size())
    throw UserError("The mask has another size than the image; give one of " + std::to_string(query.color.cols) +
                    " x " + std::to_string(query.color.rows) + " pixels.");
  if (query.mask.empty() && !options.segment)
    throw UserError("Nothing says what the foreground is; give a mask or an image with alpha, or let it be segmented.");
  if (!query.mask.empty() && cv::countNonZero(query.mask) < 64)
    throw UserError("The foreground has fewer than 64 pixels; give a mask that shows the object, or a larger image.");
  cv::Mat solid;
  if (!query.mask.empty()) cv::erode(query.mask, solid, cv::Mat());
  if (!query.mask.empty() && cv::countNonZero(solid) == 0)
    throw UserError("The foreground is nowhere three pixels wide; give a mask that shows the whole object.");
  for (double w : {options.intensity, options.high_frequency, options.depth, options.position, options.silhouette})
    if (!(w >= 0) || !std::isfinite(w)) throw UserError("A weight is negative or not a number; give 0 or more.");
  if (options.intensity + options.high_frequency + options.silhouette <= 0)
    throw UserError("The image counts nothing; raise the weight of the intensity or of the high frequencies.");
  if (options.views.empty()) throw UserError("No view is given to start from; give one, as in 0,0.");
}

cv::Mat to_query(const cv::Mat& plane, const Placement& placement, cv::Size size, int interpolation) {
  cv::Mat result;
  cv::warpAffine(plane, result, placement.matrix(), size, interpolation | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return result;
}

// The camera of the examples' frame, and from it the query's.
render::Camera query_camera(const render::Camera& example, double pixels_per_unit, const Placement& placement,
                            cv::Size size) {
  render::Camera c = example;
  const cv::Vec2d center = placement.inverse() * cv::Vec3d(c.center.x() - 0.5, c.center.y() - 0.5, 1);
  c.center = {center[0] + 0.5, center[1] + 0.5};
  c.rotation = Eigen::AngleAxisd(-placement.rotation * EIGEN_PI / 180, Vec3::UnitZ()).toRotationMatrix() * c.rotation;
  c.scale = pixels_per_unit / placement.scale;
  c.focal = 0;
  c.width = size.width, c.height = size.height;
  return c;
}

// The back side: from front depth to the second layer (thesis 4.2).
cv::Mat synthesize_back(const cv::Mat& front, const cv::Mat& mask, const ExampleSet& set,
                        const synthesis::SynthesisResult& fronts, const DepthOptions& options, Progress& progress) {
  synthesis::PatchImage query;
  query.planes = {front, cv::Mat()};
  query.mask = mask;
  std::vector<synthesis::PatchImage> examples;
  for (size_t k = 0; k < set.size(); ++k) {
    const synthesis::PatchImage& e = set[k].image;
    if (!fronts.active[k]) continue;
    if (e.planes.size() < 3)
      throw UserError("The database holds no back depth; build it with BackSide, or reconstruct without it.");
    examples.push_back({{e.planes[1], e.planes[2]}, e.mask});
  }
  synthesis::SynthesisOptions o = synthesis_options(options);
  // Silhouettes say more of the back than the front's detail does; and a back is
  // smooth, so it starts on a coarser level.
  const double known = options.depth > 0 ? 1.5 * options.depth : 0.3;
  o.channels = {{0, known, false, false}, {1, 3.3 * known, false, false}};
  o.silhouette = 5 * options.silhouette;
  o.longest_coarsest = 32;
  return synthesis::synthesize(query, examples, o, {}, progress).planes[0];
}

}  // namespace

DepthResult reconstruct_depth(const DepthQuery& given, examples::ExampleSource& source, const DepthOptions& options,
                              Progress& progress) {
  DepthQuery query = given;
  check_image(query.color);
  if (query.mask.empty() && !options.segment) query.mask = plain_background_mask(query.color);
  check(query, options);
  DepthResult result;
  Gallery gallery(source, options.objects, options.seed);
  if (gallery.size() == 0) throw UserError("The database holds no example; choose another.");

  if (options.segment) {
    progress.stage("Segmenting", 0, 5);
    query.mask = segment(query, gallery, options, progress);
  }
  progress.stage("Aligning", 5, 10);
  const Placement placement =
      options.align ? align_query(query, gallery, options) : fit_query(query, gallery.image_size());
  result.scale = placement.scale, result.rotation = placement.rotation;
  const synthesis::PatchImage placed = place(query, placement, gallery.image_size());
  if (cv::countNonZero(placed.mask) < 16)
    throw UserError("The object is too small in the image; give one that it fills, or align it.");
  const synthesis::PatchImage small = thumbnail(placed, Gallery::thumbnail_size);

  progress.stage("Searching the view", 10, 35);
  std::vector<render::View> views = options.views;
  const std::optional<examples::Light> given_light = source.light();
  const auto search_light = [&](const render::View& view) {
    if (options.update_light && given_light) gallery.set_light(find_light(small, gallery, view, options));
  };
  search_light(views.front());
  std::optional<render::View> found;
  if (options.update_views) {
    found = find_view(small, gallery, options, progress);
    const auto near = std::find_if(views.begin(), views.end(), [&](const render::View& v) {
      return examples::angle_between(v, *found) < same_view;
    });
    views = {near != views.end() ? *near : *found};
    if (examples::angle_between(views.front(), options.views.front()) > 2 * same_view) search_light(views.front());
  }

  progress.stage("Choosing examples", 35, 40);
  ExampleSet set(gallery, options, views, small);
  synthesis::PatchImage work = placed;
  work.planes.resize(2);
  std::vector<synthesis::PatchImage> examples;
  for (size_t k = 0; k < set.size(); ++k) examples.push_back(set.front(k));

  Progress part = progress.part(40, options.back ? 75 : 95);
  const synthesis::SynthesisResult fronts = synthesis::synthesize(
      work, examples, synthesis_options(options),
      [&](const synthesis::SynthesisState& state) { return set.update(state); }, part);
  examples.clear();

  cv::Mat back;
  if (options.back) {
    Progress backs = progress.part(75, 95);
    back = synthesize_back(fronts.planes[0], work.mask, set, fronts, options, backs);
  }

  progress.stage("Judging", 95, 100);
  result.light = gallery.light();
  result.strangeness = strangeness(small, set, options);
  result.trusted = result.strangeness < untrusted;
  result.plausibility = fronts.objective;
  double patches = 0, middle = 0, yaw = 0, pitch = 0;
  size_t most = 0;
  for (size_t k = 0; k < set.size(); ++k) {
    const double n = double(fronts.used[k]);
    result.used.push_back({gallery.name(set[k].object), set[k].view, fronts.used[k]});
    patches += n, middle += n * set[k].middle, yaw += n * set[k].view.yaw, pitch += n * set[k].view.pitch;
    if (fronts.used[k] > fronts.used[most]) most = k;
  }
  middle /= patches;
  result.view = found && gallery.has_any_view() ? *found : render::View{yaw / patches, pitch / patches};

  // Back into the query's pixels, and into the database's units.
  const cv::Size size = query.color.size();
  const double pixels_per_unit = set[most].pixels_per_unit;
  result.camera = query_camera(set[most].camera, pixels_per_unit, placement, size);
  result.mask = query.mask != 0;
  const auto world = [&](const cv::Mat& plane) {
    cv::Mat depth =
        to_query(synthesis::extend(plane, work.mask), placement, size, cv::INTER_CUBIC) / pixels_per_unit + middle;
    depth.setTo(std::numeric_limits<float>::quiet_NaN(), result.mask == 0);
    return depth;
  };
  result.depth = world(fronts.planes[0]);
  if (!back.empty()) {
    result.back_depth = world(back);
    result.back_depth = cv::max(result.back_depth, result.depth);
    result.back_depth.setTo(std::numeric_limits<float>::quiet_NaN(), result.mask == 0);
  }
  cv::Mat example;
  fronts.example.convertTo(example, CV_32F);
  to_query(example, placement, size, cv::INTER_NEAREST).convertTo(result.example, CV_32S);
  result.example.setTo(-1, result.mask == 0);
  if (given_light) source.set_light(*given_light);
  result.distance = to_query(fronts.distance, placement, size, cv::INTER_NEAREST);
  return result;
}

}  // namespace parts::depth
