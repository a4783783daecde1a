// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "filters.h"
#include "parts/base/error.h"
#include "parts/depth/reconstruct_depth.h"
#include "parts/depth/segment.h"
#include "parts/examples/examples.h"
#include "parts/host/common.h"
#include "parts/io/raster_io.h"
#include "parts/render/depth_mesh.h"
#include "parts/render/texture.h"
#include "parts/synthesis/usage_picture.h"

namespace parts {
namespace {

using namespace host;

constexpr const char* slug = "reconstruct_depth";
const std::vector<const char*> outputs{"DepthFile", "BackDepthFile", "UsageFile", "MaskFile", "TextureFile"};
constexpr int largest_frame = 800;  ///< pixels that examples are rendered in

std::vector<Parameter> parameters(const Scene&) {
  const depth::DepthOptions o;
  const std::string by_class = " At its default, the class's preset counts where the database has one.";
  return {
      open_file("Image", {"png", "jpg", "jpeg", "tif", "tiff", "bmp"}, "Image",
                "The image of the object. Empty: the current raster layer."),
      open_file("Mask", {"png", "tif", "tiff", "bmp"}, "Mask",
                "An image of the same size, bright where the object is. Empty: the image's alpha, or what is unlike a "
                "border of one colour."),
      open_file("Database", {"mlp", "ply", "obj", "off", "stl"}, "Database",
                "The examples of the class: a mapping database, or models (a project or a folder, for which any file "
                "of it stands) that are rendered as they are needed."),
      integer("Examples", o.examples, 1, 1000, "Examples", "How many are searched at a time."),
      text("PatchSizes", "5,7,9", "Patch sizes",
           "Sides of the patches in pixels, odd, coarse to fine; their number is the number of pyramid levels (large "
           "images get more of the first size)." +
               by_class),
      number("WeightIntensity", o.intensity, 0, 1e6, "Weight of intensity",
             "How much a patch's normalised intensities count." + by_class),
      number("WeightHighFrequency", o.high_frequency, 0, 1e6, "Weight of high frequencies",
             "How much the detail of its intensities counts." + by_class),
      number("WeightDepth", o.depth, 0, 1e6, "Weight of depth",
             "How much the depth found so far counts: more gives smoother surfaces." + by_class),
      number("WeightPosition", o.position, 0, 1e6, "Weight of position",
             "How much the place relative to the foreground's centroid counts: high for faces, low for what moves "
             "its limbs." +
                 by_class),
      flag("UpdateObjects", o.update_objects, "Better objects",
           "Replaces the least used quarter of the examples on each level by those whose depth is most like the "
           "estimate."),
      flag("UpdateViews", o.update_views, "Search the view",
           "Searches from where the object is seen, up to 40 degrees around the views given. Without it the views are "
           "used as they are."),
      flag("UpdateLight", o.update_light, "Search the light",
           "Renders the examples in the light that the image seems to be taken in. Not for stored examples."),
      flag("AlignQuery", o.align, "Align the image",
           "Turns and scales the image in its plane to fit the examples, where that fits clearly better."),
      flag("Segment", o.segment, "Find the foreground",
           "Finds the object in the image (within the mask, if one is given)."),
      flag("BackSide", o.back, "Back side", "Reconstructs the far side too, and closes both into one solid."),
      integer("MaxIterations", o.max_iterations, 1, 1000, "Iterations", "At most so many on each level."),
      integer("Seed", 0, 0, 1000000, "Seed", "Chooses the objects that take part where the database has more than 64."),
      text("Views", "0,0", "Start views",
           "From where the object may be seen: yaw,pitch in degrees, separated by semicolons."),
      save_file("DepthFile", "tif", "Depth file", "Where the depth is written (32-bit float TIFF or PFM)."),
      save_file("BackDepthFile", "tif", "Back depth file", "Where the back's depth is written."),
      save_file("UsageFile", "png", "Usage file",
                "Where an image is written that shows, as a colour, which example each pixel came from."),
      save_file("MaskFile", "png", "Mask file", "Where the foreground is written."),
      save_file("TextureFile", "png", "Texture file",
                "Where the texture is written. Empty: the image itself where MeshLab can show it as it is, or else a "
                "new file beside it. Inputs are never replaced."),
  };
}

depth::DepthOptions options_of(const Inputs& inputs, const io::ClassPreset& preset) {
  depth::DepthOptions o;
  o.patch_sizes = parse_patch_sizes(class_text(inputs, preset, slug, "PatchSizes", "5,7,9"));
  o.examples = inputs.integer("Examples");
  o.intensity = class_number(inputs, preset, slug, "WeightIntensity", o.intensity);
  o.high_frequency = class_number(inputs, preset, slug, "WeightHighFrequency", o.high_frequency);
  o.depth = class_number(inputs, preset, slug, "WeightDepth", o.depth);
  o.position = class_number(inputs, preset, slug, "WeightPosition", o.position);
  o.update_objects = inputs.flag("UpdateObjects");
  o.update_views = inputs.flag("UpdateViews");
  o.update_light = inputs.flag("UpdateLight");
  o.align = inputs.flag("AlignQuery");
  o.segment = inputs.flag("Segment");
  o.back = inputs.flag("BackSide");
  o.max_iterations = inputs.integer("MaxIterations");
  o.seed = unsigned(inputs.integer("Seed"));
  o.views = render::parse_views(inputs.text("Views"));
  return o;
}

struct Input {
  std::string file;
  io::Image image;
  depth::DepthQuery query;
};

Input read(const Inputs& inputs) {
  Input in;
  in.file = inputs.text("Image");
  if (in.file.empty()) {
    const std::optional<RasterLayer> raster = inputs.raster();
    if (!raster) throw UserError("No image is named and there is no raster layer; choose an image or open one.");
    in.file = raster->file;
  }
  if (inputs.text("Database").empty())
    throw UserError("No database is named; choose a mapping database or a folder or project of models.");
  if (!inputs.text("BackDepthFile").empty() && !inputs.flag("BackSide"))
    throw UserError("BackDepthFile is named but BackSide is off; turn it on, or leave the name empty.");
  in.image = io::read_image(in.file);
  in.query.color = in.image.color;
  const std::string mask = inputs.text("Mask");
  if (!mask.empty())
    in.query.mask = io::read_mask(mask, in.image.color.size());
  else if (in.image.has_alpha)
    in.query.mask = in.image.mask;
  refuse_inputs(inputs, outputs, {in.file, mask, inputs.text("Database")});
  for (const char* name : outputs) {
    const bool depth = name == std::string("DepthFile") || name == std::string("BackDepthFile");
    (depth ? io::check_depth_output : io::check_image_output)(inputs.text(name));
  }
  return in;
}

/// The frame that models are rendered in, so that the object is about as large
/// in it as in the image.
cv::Size frame_for(const depth::DepthQuery& query, bool align) {
  cv::Mat mask = query.mask.empty() ? depth::plain_background_mask(query.color) : query.mask;
  cv::Size2d frame = query.color.size();
  cv::Mat points;
  if (!mask.empty()) cv::findNonZero(mask, points);
  if (align && !points.empty()) {
    int left = mask.cols, right = 0, top = mask.rows, bottom = 0;
    for (int i = 0; i < int(points.total()); ++i) {
      const cv::Point p = points.at<cv::Point>(i);
      left = std::min(left, p.x), right = std::max(right, p.x), top = std::min(top, p.y),
      bottom = std::max(bottom, p.y);
    }
    const double w = right - left + 1, h = bottom - top + 1;
    if (w < 0.4 * frame.width && h < 0.4 * frame.height) frame = {1.35 * w, 1.35 * h};
  }
  const double shrink = std::max(1., std::max(frame.width, frame.height) / largest_frame);
  return {std::max(64, int(std::lround(frame.width / shrink))), std::max(64, int(std::lround(frame.height / shrink)))};
}

std::string degrees(const render::View& v) {
  std::ostringstream out;
  out.precision(3);
  out << v.yaw << "," << v.pitch;
  return out.str();
}

/// What counted, of the user's values and the class's.
void log_options(const depth::DepthOptions& o, Progress& progress) {
  std::ostringstream sizes, weights;
  for (size_t l = 0; l < o.patch_sizes.size(); ++l) sizes << (l ? "," : "") << o.patch_sizes[l];
  weights << o.intensity << " " << o.high_frequency << " " << o.depth << " " << o.position;
  log_value(progress, "patch_sizes", sizes.str());
  log_value(progress, "weights", weights.str());
}

void log_result(const depth::DepthResult& r, Progress& progress) {
  log_value(progress, "view", degrees(r.view));
  log_value(progress, "view_yaw", r.view.yaw);
  log_value(progress, "view_pitch", r.view.pitch);
  if (r.light) {
    const Vec3 d = r.light->direction.normalized();
    std::ostringstream light;
    light.precision(3);
    light << d.x() << " " << d.y() << " " << d.z() << " " << r.light->ambient;
    log_value(progress, "light", light.str());
  }
  log_value(progress, "scale", r.scale);
  log_value(progress, "rotation", r.rotation);
  log_value(progress, "levels", double(r.plausibility.size()));
  std::ostringstream plausibility, examples;
  for (size_t l = 0; l < r.plausibility.size(); ++l) {
    if (l > 0) plausibility << "; ";
    for (size_t i = 0; i < r.plausibility[l].size(); ++i) plausibility << (i ? " " : "") << r.plausibility[l][i];
  }
  log_value(progress, "plausibility", plausibility.str());
  std::vector<size_t> order(r.used.size());
  for (size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return r.used[a].patches > r.used[b].patches; });
  for (size_t k : order)
    if (r.used[k].patches > 0)
      examples << (examples.tellp() > 0 ? "; " : "") << r.used[k].object << " " << degrees(r.used[k].view) << " "
               << r.used[k].patches;
  log_value(progress, "examples_used", examples.str());
  log_value(progress, "foreground_pixels", cv::countNonZero(r.mask));
  log_value(progress, "mean_patch_distance", cv::mean(r.distance, r.mask)[0]);
  log_value(progress, "strangeness", r.evidence.strangeness);
  log_value(progress, "trusted", r.trusted ? "yes" : "no");
  log_value(progress, "silhouette_overlap", r.evidence.silhouette);
  log_value(progress, "halves_difference", r.evidence.halves);
  log_value(progress, "view_margin", r.evidence.view_margin);
}

/// Why a result is not to be trusted, and what all the figures are.
std::string doubt(const depth::Evidence& e) {
  std::ostringstream text;
  text.precision(2);
  text << "The result is not to be trusted: the image may be of another class, or of a pose or light that no example "
          "has (patches "
       << e.strangeness << " times as far as those of the strangest member, silhouettes alike to " << 100 * e.silhouette
       << " %, two halves of the database apart by " << 100 * e.halves << " % of the depth";
  if (e.view_margin > 0) text << ", seen from elsewhere " << e.view_margin << " times as far";
  text << ").";
  return text.str();
}

/// @return the texture's file
std::string draft_files(const depth::DepthResult& r, const Input& in, const Inputs& inputs, OutputFiles& files) {
  io::add_depth(files, r.depth, inputs.text("DepthFile"));
  io::add_depth(files, r.back_depth, inputs.text("BackDepthFile"));
  io::add_image(files, synthesis::usage_picture(r.example, cv::Scalar::all(255)), inputs.text("UsageFile"));
  io::add_image(files, r.mask, inputs.text("MaskFile"));
  std::string texture = inputs.text("TextureFile");
  if (texture.empty() && render::shows_as_texture(in.file, in.image))
    texture = std::filesystem::absolute(in.file).lexically_normal().string();
  else
    texture = render::add_texture(files, in.image.color, r.mask,
                                  {texture, in.file, {in.file, inputs.text("Mask"), inputs.text("Database")}});
  return texture;
}

Outcome apply(const Inputs& inputs, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  progress.stage("Reading", 0, 15);
  const Input in = read(inputs);
  const std::string database = inputs.text("Database");
  examples::ExampleOptions rendering;
  const cv::Size frame = frame_for(in.query, inputs.flag("AlignQuery"));
  rendering.width = frame.width, rendering.height = frame.height;
  rendering.back = inputs.flag("BackSide");
  Progress opening = progress.part(0, 15);
  const auto source = examples::open_examples(database, render::parse_views(inputs.text("Views")), rendering, opening);
  refuse_inputs(inputs, outputs, source->files());
  const depth::DepthOptions options = options_of(inputs, source->preset());

  Progress core = progress.part(15, 90);
  const depth::DepthResult r = depth::reconstruct_depth(in.query, *source, options, core);
  progress.stage("Meshing", 90, 100);
  Progress meshing = progress.part(90, 98);
  render::DepthMesh result = render::depth_to_mesh(r.depth, r.back_depth, r.camera, {}, meshing);

  Outcome outcome;
  result.mesh.textures = {draft_files(r, in, inputs, *outcome.files)};

  log_value(progress, "objects", source->size());
  log_value(progress, "frame_width", source->image_size().width);
  log_value(progress, "frame_height", source->image_size().height);
  log_options(options, progress);
  log_result(r, progress);
  log_value(progress, "texture", result.mesh.textures[0]);
  log_value(progress, "vertices", result.mesh.vertex_count());
  log_value(progress, "faces", result.mesh.face_count());
  log_value(progress, "seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  if (!r.trusted) log_value(progress, "warning", doubt(r.evidence));
  outcome.layers.push_back({r.trusted ? "Reconstructed" : "Reconstructed (not trusted)", std::move(result.mesh), true,
                            r.camera, check_of_depth(options.back)});
  outcome.current = 0;
  return outcome;
}

}  // namespace

host::Filter reconstruct_depth_filter() {
  return {"Examples: Reconstruct Depth from Image",
          slug,
          Menu::Creation,
          std::string("Estimates the depth of an object of a known class from one image, by example: each patch of "
                      "the image and its depth shall look like one of models of the class. Says from where the object "
                      "is seen, which example each pixel came from, and when the image is unlike the class. For a "
                      "closed class, of which there are models; not for arbitrary scenes.") +
              depth_reference,
          parameters,
          apply};
}

}  // namespace parts
