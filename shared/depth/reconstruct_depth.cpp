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
#include "parts/depth/small_level.h"
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
  if (options.patch_sizes.empty()) throw UserError("No patch size is given; give one for each level, as in 5,7,9.");
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

/// Restores the light of a source, also where an exception ends the work.
class KeptLight {
 public:
  explicit KeptLight(examples::ExampleSource& source) : source_(source), light_(source.light()) {}
  ~KeptLight() {
    if (light_) source_.set_light(*light_);
  }
  KeptLight(const KeptLight&) = delete;
  KeptLight& operator=(const KeptLight&) = delete;

 private:
  examples::ExampleSource& source_;
  std::optional<examples::Light> light_;
};

/// The query in the examples' frame.
struct PlacedQuery {
  Placement placement;
  synthesis::PatchImage whole, small;  ///< {intensity}; small: at the scale of Gallery::small
};

PlacedQuery place_in_frame(const DepthQuery& query, Gallery& gallery, const DepthOptions& options) {
  PlacedQuery q;
  q.placement = options.align ? align_query(query, gallery, options) : fit_query(query, gallery.image_size());
  q.whole = place(query, q.placement, gallery.image_size());
  if (cv::countNonZero(q.whole.mask) < 16)
    throw UserError("The object is too small in the image; give one that it fills, or align it.");
  q.small = thumbnail(q.whole, Gallery::thumbnail_size);
  return q;
}

/// From where examples are taken.
struct Viewpoints {
  std::vector<render::View> views;
  std::optional<render::View> found;  ///< nothing where it was not searched
};

bool same_light(const std::optional<examples::Light>& a, const std::optional<examples::Light>& b) {
  return a.has_value() == b.has_value() && (!a || (a->direction == b->direction && a->ambient == b->ambient));
}

/// Searches the view and the light as far as the options ask for it, by turns: a
/// light that was found from the wrong view may have misled the search for the
/// view. The gallery is left in the light that was found.
Viewpoints search_view_and_light(const synthesis::PatchImage& small, Gallery& gallery, const DepthOptions& options,
                                 Progress& progress) {
  Viewpoints result{options.views, {}};
  const auto search_light = [&](const render::View& view) {
    const std::optional<examples::Light> before = gallery.light();
    if (options.update_light && before) gallery.set_light(find_light(small, gallery, view, options));
    return !same_light(before, gallery.light());
  };
  const auto is_near = [&](const render::View& v) { return render::angle_between(v, *result.found) < same_view; };
  progress.stage("Searching the view", 10, 24);
  search_light(options.views.front());
  if (!options.update_views) return result;
  result.found = find_view(small, gallery, options, progress);
  if (render::angle_between(*result.found, options.views.front()) > 2 * same_view && search_light(*result.found)) {
    progress.stage("Searching the view", 24, 35);
    result.found = find_view(small, gallery, options, progress);
  }
  const auto near = std::find_if(options.views.begin(), options.views.end(), is_near);
  result.views = {near != options.views.end() ? *near : *result.found};
  return result;
}

/// The front's depth, in pixels; the examples change meanwhile.
synthesis::SynthesisResult synthesize_front(const synthesis::PatchImage& placed, ExampleSet& set,
                                            const DepthOptions& options, Progress& progress) {
  synthesis::PatchImage query = placed;
  query.planes.resize(2);
  std::vector<synthesis::PatchImage> examples;
  for (size_t k = 0; k < set.size(); ++k) examples.push_back(set.front(k));
  return synthesis::synthesize(
      query, examples, synthesis_options(options),
      [&](const synthesis::SynthesisState& state) { return set.update(state); }, progress);
}

/// The back side: from front depth to the second layer (thesis 4.2).
cv::Mat synthesize_back(const cv::Mat& mask, const ExampleSet& set, const synthesis::SynthesisResult& fronts,
                        const DepthOptions& options, Progress& progress) {
  synthesis::PatchImage query;
  query.planes = {fronts.planes[0], cv::Mat()};
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

/// How examples' pixels and depths become the query's and the database's.
struct ToWorld {
  render::Camera camera;       ///< of the example that gave most
  double pixels_per_unit = 1;  ///< of the same
  double middle = 0;           ///< of all that gave, weighted by their patches: the depth that planes are about
};

/// Which examples gave what. Fills used and view.
ToWorld count_examples(const ExampleSet& set, const synthesis::SynthesisResult& fronts,
                       const std::optional<render::View>& found, DepthResult& result) {
  double patches = 0, middle = 0, yaw = 0, pitch = 0;
  size_t most = 0;
  for (size_t k = 0; k < set.size(); ++k) {
    const double n = double(fronts.used[k]);
    result.used.push_back({set.gallery().name(set[k].object), set[k].view, fronts.used[k]});
    patches += n, middle += n * set[k].middle, yaw += n * set[k].view.yaw, pitch += n * set[k].view.pitch;
    if (fronts.used[k] > fronts.used[most]) most = k;
  }
  result.view = found && set.gallery().has_any_view() ? *found : render::View{yaw / patches, pitch / patches};
  return {set[most].camera, set[most].pixels_per_unit, middle / patches};
}

/// Back into the query's pixels, and into the database's units. Fills the rasters and the camera.
void bring_back(const DepthQuery& query, const PlacedQuery& placed, const ToWorld& to_world,
                const synthesis::SynthesisResult& fronts, const cv::Mat& back, DepthResult& result) {
  const cv::Size size = query.color.size();
  result.camera = query_camera(to_world.camera, to_world.pixels_per_unit, placed.placement, size);
  result.mask = query.mask != 0;
  const cv::Mat background = result.mask == 0;
  const float none = std::numeric_limits<float>::quiet_NaN();
  const auto world = [&](const cv::Mat& plane) {
    cv::Mat depth = to_query(synthesis::extend(plane, placed.whole.mask), placed.placement, size, cv::INTER_CUBIC) /
                        to_world.pixels_per_unit +
                    to_world.middle;
    depth.setTo(none, background);
    return depth;
  };
  result.depth = world(fronts.planes[0]);
  if (!back.empty()) {
    result.back_depth = cv::max(world(back), result.depth);
    result.back_depth.setTo(none, background);
  }
  cv::Mat example;
  fronts.example.convertTo(example, CV_32F);
  to_query(example, placed.placement, size, cv::INTER_NEAREST).convertTo(result.example, CV_32S);
  result.example.setTo(-1, background);
  result.distance = to_query(fronts.distance, placed.placement, size, cv::INTER_NEAREST);
}

}  // namespace

DepthResult reconstruct_depth(const DepthQuery& given, examples::ExampleSource& source, const DepthOptions& options,
                              Progress& progress) {
  DepthQuery query = given;
  check_image(query.color);
  if (query.mask.empty() && !options.segment) query.mask = plain_background_mask(query.color);
  check(query, options);
  const KeptLight kept(source);
  Gallery gallery(source, options.objects, options.seed);
  if (gallery.size() == 0) throw UserError("The database holds no example; choose another.");

  if (options.segment) {
    progress.stage("Segmenting", 0, 5);
    query.mask = segment(query, gallery, options, progress);
  }
  progress.stage("Aligning", 5, 10);
  const PlacedQuery placed = place_in_frame(query, gallery, options);
  const Viewpoints from = search_view_and_light(placed.small, gallery, options, progress);
  progress.stage("Choosing examples", 35, 40);
  ExampleSet set(gallery, options, from.views, placed.small);
  Progress front_part = progress.part(40, options.back ? 75 : 95);
  const synthesis::SynthesisResult fronts = synthesize_front(placed.whole, set, options, front_part);
  cv::Mat back;
  if (options.back) {
    Progress back_part = progress.part(75, 95);
    back = synthesize_back(placed.whole.mask, set, fronts, options, back_part);
  }

  progress.stage("Judging", 95, 100);
  DepthResult result;
  result.scale = placed.placement.scale, result.rotation = placed.placement.rotation;
  result.light = gallery.light();
  result.evidence = gather_evidence(placed.small, set, options);
  result.trusted = is_trusted(result.evidence);
  result.plausibility = fronts.objective;
  const ToWorld to_world = count_examples(set, fronts, from.found, result);
  bring_back(query, placed, to_world, fronts, back, result);
  return result;
}

}  // namespace parts::depth
