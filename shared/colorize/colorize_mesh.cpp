// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/colorize/colorize_mesh.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "parts/align/align.h"
#include "parts/base/error.h"
#include "parts/base/files.h"
#include "parts/base/memory.h"
#include "parts/colorize/color_examples.h"
#include "parts/colorize/find_frame.h"
#include "parts/colorize/kept_colors.h"
#include "parts/colorize/posed_mesh.h"
#include "parts/mesh/attributes.h"
#include "parts/render/rasterize.h"
#include "parts/render/surface_color.h"
#include "parts/synthesis/pyramid.h"

namespace parts::colorize {
namespace {

constexpr int kComparison = 96;  // pixels of views by which models are compared
constexpr int kSearched = 256;   // of the finest level at which patches are searched
constexpr int kCoarsest = 64;    // of the coarsest level, at most

/// Side by side; all of one height.
synthesis::PatchImage beside(const std::vector<synthesis::PatchImage>& images) {
  synthesis::PatchImage all;
  const auto join = [&](const auto& part, cv::Mat& to) {
    std::vector<cv::Mat> row;
    for (const synthesis::PatchImage& i : images) row.push_back(part(i));
    cv::hconcat(row, to);
  };
  join([](const synthesis::PatchImage& i) { return i.mask; }, all.mask);
  all.planes.resize(images.front().planes.size());
  for (std::size_t p = 0; p < all.planes.size(); ++p)
    join([p](const synthesis::PatchImage& i) { return i.planes[p]; }, all.planes[p]);
  return all;
}

/// A model's vertices in the frame of the views.
Mesh in_frame(const examples::ClassModel& model) {
  Mesh mesh;
  mesh.faces = model.mesh.faces;
  for (const Vec3& v : model.mesh.vertices) mesh.vertices.push_back((v - model.center) / model.size);
  return mesh;
}

/// Moves the query onto a model where they are nearly aligned already.
bool align(examples::ClassModel& query, const examples::ClassModel& model, int threads, Progress& progress) {
  constexpr double kMostTurned = 20 * EIGEN_PI / 180, kMostScaled = 1.5, kGain = 0.9;
  align::AlignOptions options;
  options.coarse = false, options.allow_scale = true, options.overlap = 0.75, options.threads = threads;
  const align::AlignResult found = align::align_part_in_whole(query.mesh, {}, in_frame(model), {}, options, progress);
  const Eigen::Matrix3d linear = found.matrix.topLeftCorner<3, 3>();
  const double scale = std::cbrt(std::abs(linear.determinant()));
  const double turned = Eigen::AngleAxisd(Eigen::Matrix3d(linear / scale)).angle();
  if (turned > kMostTurned || scale > kMostScaled || scale < 1 / kMostScaled ||
      found.rms_after > kGain * found.rms_before)
    return false;
  query.mesh = mesh::transformed(std::move(query.mesh), Eigen::Affine3d(found.matrix));
  return true;
}

/// Compares the query with every model by small views, and keeps those that give their colours.
std::vector<ColorExample> choose(const examples::ClassModel& query, examples::ClassModels& models,
                                 const ColorizeMeshOptions& options, double frame, ColorizeReport& report,
                                 Progress& progress) {
  examples::ExampleOptions small = options.rendering;
  const double shrink = std::min(1.0, double(kComparison) / std::max(small.width, small.height));
  small.width = std::max(8, int(small.width * shrink)), small.height = std::max(8, int(small.height * shrink));
  const std::vector<examples::Example> views = see(query, frame * shrink, options.views, small);
  std::vector<synthesis::PatchImage> tiles = planes_of(views);
  const synthesis::PatchImage seen = beside(tiles);
  synthesis::PatchImage kept;
  if (!options.keep.empty()) {
    const std::vector<cv::Mat> masks = kept_pixels(query, options.keep, views);
    for (std::size_t v = 0; v < tiles.size(); ++v) tiles[v].mask = masks[v];
    kept = beside(tiles);
  }
  if (cv::countNonZero(seen.mask) < 16) throw UserError("No view shows the mesh; check Views, Up and Front.");
  std::vector<std::string> names;
  for (int i = 0; i < models.size(); ++i) names.push_back(models.name(i));
  std::vector<ColorExample> all;
  for (int i : choosable(names, options.choose)) {
    progress.at(double(i) / models.size());
    const examples::ClassModel& model = models.get(i);
    if (!render::has_colors(model.mesh, model.textures)) {
      progress.log("without_colours: " + model.name);
      continue;
    }
    all.push_back({i, names[i], 0, beside(planes_of(see(model, frame * shrink, options.views, small)))});
  }
  if (all.empty())
    throw UserError("No model of the database has colours; give models with textures or vertex colours.");
  select_examples(all, seen, kept, options, report);
  return all;
}

/// What of each view holds the query or an example.
std::vector<cv::Rect> used_parts(const std::vector<std::vector<synthesis::PatchImage>>& objects) {
  std::vector<cv::Rect> parts;
  for (std::size_t v = 0; v < objects.front().size(); ++v) {
    cv::Mat any = objects.front()[v].mask.clone();
    for (const auto& views : objects) any |= views[v].mask;
    const cv::Rect all({0, 0}, any.size()), box = cv::boundingRect(any);
    parts.push_back(box.empty() ? cv::Rect(0, 0, 1, 1)
                                : cv::Rect(box.x - 4, box.y - 4, box.width + 8, box.height + 8) & all);
  }
  return parts;
}

/// Levels to search, those above them that only carry matches on.
synthesis::SynthesisOptions synthesis_for(const ColorizeMeshOptions& options, int longest, double foreground) {
  synthesis::SynthesisOptions s = color_synthesis(options);
  s.size = std::sqrt(foreground);
  s.longest_coarsest = 0;
  if (s.patch_sizes.empty()) return s;  // the engine says so
  while ((longest >> s.carried) > kSearched) ++s.carried;
  while ((longest >> (s.carried + int(s.patch_sizes.size()) - 1)) > kCoarsest)
    s.patch_sizes.insert(s.patch_sizes.begin(), s.patch_sizes.front());
  s.patch_sizes.insert(s.patch_sizes.end(), s.carried, s.patch_sizes.back());
  return s;
}

void check_memory(const std::vector<cv::Rect>& parts, std::size_t images) {
  constexpr double kBytes = 180;  // a pixel and image: planes, bands, pyramids, matches
  double pixels = 0;
  for (const cv::Rect& part : parts) pixels += double(part.area());
  parts::check_memory("Colouring these views", pixels * kBytes * double(images), available_memory(),
                      "choose a smaller Width and Height, fewer Views or fewer Examples");
}

/// Whether nearly all that is seen are front faces.
bool faces_outwards(const examples::ClassModel& query, double frame, const ColorizeMeshOptions& options) {
  long front = 0, all = 0;
  examples::ExampleOptions small = options.rendering;
  for (const render::View& view : options.views) {
    render::Camera camera;
    camera.rotation = render::view_rotation(view, small.up, small.front);
    camera.width = camera.height = kComparison;
    camera.center = {kComparison / 2., kComparison / 2.};
    camera.scale = frame * kComparison / std::max(small.width, small.height);
    camera.eye = camera.rotation.row(2).transpose();
    render::RenderOptions look;
    look.threads = options.threads;
    const cv::Mat face = render::render(query.mesh, {}, camera, look).face;
    for (int y = 0; y < face.rows; ++y)
      for (int x = 0; x < face.cols; ++x)
        if (const int f = face.at<int>(y, x); f >= 0) {
          front += query.mesh.area_vector(f).dot(camera.rotation.row(2)) > 0, ++all;
        }
  }
  return double(front) > 0.95 * double(all);
}

}  // namespace

MeshColors colorize_mesh(const Mesh& mesh, examples::ClassModels& models, const ColorizeMeshOptions& given,
                         Progress& progress) {
  ColorizeMeshOptions options = given;
  options.centered = false;
  if (mesh.faces.empty()) throw UserError("The mesh has no faces; choose a layer that holds a surface.");
  if (options.views.empty()) throw UserError("No view is given; give yaw,pitch in degrees, as in 0,0; 90,0; 180,0.");
  MeshColors result;
  examples::ClassModel query = pose(mesh, models, options);
  if (options.find_frame) {
    progress.stage("Finding how the mesh stands", 0, 2);
    result.turned = find_frame(query.mesh, models, options);
    if (result.turned) {
      options.up = result.turned->up, options.front = result.turned->front;
      query = pose(mesh, models, options);
    }
  }
  double frame = frame_for(query, models, options);
  progress.stage("Comparing with the models", 2, 20);
  std::vector<ColorExample> examples = choose(query, models, options, frame, result, progress);
  if (options.align) {
    Progress aligning = progress.part(20, 25);
    result.aligned = align(query, models.get(examples.front().object), options.threads, aligning);
    if (result.aligned) {
      frame = frame_for(query, models, options);
      progress.stage("Comparing with the models", 25, 30);
      examples = choose(query, models, options, frame, result, progress);
    }
  }
  const std::vector<examples::Example> seen = see(query, frame, options.views, options.rendering);
  std::vector<std::vector<synthesis::PatchImage>> planes{planes_of(seen)};
  for (ColorExample& e : examples)
    planes.push_back(planes_of(see(models.get(e.object), frame, options.views, options.rendering)));
  const std::vector<cv::Rect> parts = used_parts(planes);
  check_memory(parts, planes.size());

  double foreground = 0;
  for (const synthesis::PatchImage& image : planes[0]) foreground += cv::countNonZero(image.mask);
  const synthesis::SynthesisOptions engine = synthesis_for(
      options, std::max(options.rendering.width, options.rendering.height), foreground / double(seen.size()));
  const int gap = engine.patch_sizes.empty() ? 1 : engine.patch_sizes.front() / 2 + 1;
  result.sheet = ViewSheet(seen, parts, std::max(1, int(engine.patch_sizes.size())), gap, options.threads);
  synthesis::PatchImage sheet = result.sheet.assemble(planes[0]);
  for (int k : engine.synthesized) sheet.planes[k].release();
  for (std::size_t k = 0; k < examples.size(); ++k) examples[k].image = result.sheet.assemble(planes[k + 1]);
  planes.clear();
  const int like = examples.front().object;
  const std::vector<synthesis::PatchImage> images = prepare_examples(std::move(examples), options, result);

  Progress synthesis = progress.part(30, 90);
  const synthesis::SynthesisResult found = synthesis::synthesize(
      sheet, images, engine, {}, synthesis, [&](int level, std::vector<cv::Mat>& p) { result.sheet.agree(level, p); });
  report_synthesis(found, sheet.mask, result);
  for (const cv::Mat& plane : found.planes) result.planes.push_back(synthesis::extend(plane, sheet.mask));
  result.example = found.example;
  result.oriented = faces_outwards(query, frame, options);
  progress.stage("Colouring the surface", 90, 100);
  result.keep = options.keep;
  color_surface(query, models.get(like), options.threads, result);
  return result;
}

}  // namespace parts::colorize
