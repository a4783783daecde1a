// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <filesystem>
#include <sstream>

#include "colorize/colorize_depth.h"
#include "filters.h"
#include "geometry/error.h"
#include "host/common.h"
#include "mappings/examples.h"
#include "raster/depth_mesh.h"
#include "raster/raster_io.h"
#include "raster/texture.h"
#include "synthesis/usage_picture.h"

namespace parts {
namespace {

using namespace host;

constexpr const char *slug = "colorize_depth", *patch_sizes = "9,11,7";
constexpr int kMostPixels = 1000;  // of the longer side of examples that are rendered

std::vector<Parameter> parameters(const Scene&) {
  const ColorizeOptions o;
  return {
      open_file("Depth", {"tif", "tiff", "pfm", "png"}, "Depth",
                "The depth raster: a 32-bit float TIFF or PFM, or a 16-bit PNG. Depth grows away from the camera; 0, "
                "infinity and NaN are background. Its unit does not matter."),
      open_file("Database", {"mlp", "ply", "obj", "off", "stl"}, "Database",
                "Objects of the same class with colours: a mapping database, or a database of textured or "
                "vertex-coloured models, which are rendered from the front without shading."),
      integer("Examples", o.examples, 1, 1000, "Examples",
              "How many objects give their colours. 1 morphs one image-map onto the new shape."),
      text("Choose", "", "Choose",
           "Labels of the examples to use, separated by semicolons. Empty: those whose depth is most similar."),
      text("PatchSizes", patch_sizes, "Patch sizes",
           "Windows' sides in pixels, odd, from coarse to fine; as many as there are levels."),
      number("WeightDepth", o.weight_depth, 0, 1e6, "Weight of depth",
             "1: a difference of one standard deviation of the class counts 1."),
      number("WeightHighFrequency", o.weight_detail, 0, 1e6, "Weight of detail", "Of the depth's high frequencies."),
      number("WeightY", o.weight_y, 0, 1e6, "Weight of Y", "Of the brightness found so far."),
      number("WeightCb", o.weight_cb, 0, 1e6, "Weight of Cb", "Of the blueness found so far."),
      number("WeightCr", o.weight_cr, 0, 1e6, "Weight of Cr", "Of the redness found so far."),
      number("WeightPosition", o.weight_position, 0, 1e6, "Weight of position",
             "Of the place relative to the object's middle; lower it for classes without structure."),
      number("PcaShare", o.pca_share, 0.001, 1, "Share of components",
             "Of the principal components of patches by which candidates are looked up. Less is quicker."),
      integer("MaxIterations", o.max_iterations, 1, 1000, "Iterations", "At most so many a level."),
      integer("Seed", 0, 0, 1000000000, "Seed",
              "0: the most similar examples. Other values draw one of the more similar half, for variety."),
      save_file("ImageFile", "png", "Image",
                "Where the image-map is written, transparent in the background. Empty: not at all."),
      save_file("UsageFile", "png", "Usage picture",
                "Where a picture of the sources is written: a colour for each example. Empty: not at all."),
      flag("AddMesh", true, "Add a mesh",
           "Adds the depth as a mesh with the image-map as its texture, a file beside the image or the depth."),
  };
}

std::vector<std::string> labels(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string label; std::getline(in, label, ';');) {
    const auto begin = label.find_first_not_of(" \t"), end = label.find_last_not_of(" \t");
    if (begin != std::string::npos) all.push_back(label.substr(begin, end - begin + 1));
  }
  return all;
}

ColorizeOptions options_of(const Inputs& inputs, const ClassPreset& preset) {
  const auto weight = [&](const char* name, double fallback) {
    return class_number(inputs, preset, slug, name, fallback);
  };
  ColorizeOptions o;
  o.examples = inputs.integer("Examples");
  o.choose = labels(inputs.text("Choose"));
  o.patch_sizes = parse_patch_sizes(class_text(inputs, preset, slug, "PatchSizes", patch_sizes));
  o.weight_depth = weight("WeightDepth", o.weight_depth);
  o.weight_detail = weight("WeightHighFrequency", o.weight_detail);
  o.weight_y = weight("WeightY", o.weight_y);
  o.weight_cb = weight("WeightCb", o.weight_cb);
  o.weight_cr = weight("WeightCr", o.weight_cr);
  o.weight_position = weight("WeightPosition", o.weight_position);
  o.pca_share = inputs.number("PcaShare");
  o.max_iterations = inputs.integer("MaxIterations");
  o.seed = unsigned(inputs.integer("Seed"));
  return o;
}

/// Models are rendered without shading, about as large as the depth map.
ExampleOptions rendering(cv::Size depth) {
  ExampleOptions o;
  const double scale = std::min(1.0, double(kMostPixels) / std::max(depth.width, depth.height));
  o.width = std::clamp(int(depth.width * scale), 8, kMostPixels);
  o.height = std::clamp(int(depth.height * scale), 8, kMostPixels);
  o.ambient = 1, o.back = false;
  return o;
}

void log_result(const ColorizeResult& r, Progress& progress) {
  for (std::size_t k = 0; k < r.used.size(); ++k) {
    std::ostringstream line;
    line << r.used[k] << " " << r.shares[k];
    log_value(progress, "example", line.str());
  }
  for (const std::string& label : r.harmonized) log_value(progress, "harmonized", label);
  for (std::size_t level = 0; level < r.objective.size(); ++level)
    for (double value : r.objective[level]) log_value(progress, "plausibility", value);
  log_value(progress, "aligned", r.aligned);
  log_value(progress, "patch_distance", r.patch_distance);
}

Outcome apply(const Inputs& inputs, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const std::string depth_file = inputs.text("Depth"), database = inputs.text("Database");
  const std::string image_file = inputs.text("ImageFile"), usage_file = inputs.text("UsageFile");
  if (depth_file.empty()) throw UserError("No depth raster is named; choose a float TIFF, a PFM or a 16-bit PNG.");
  if (database.empty()) throw UserError("No database is named; choose a project or a folder of coloured models.");
  const bool add_mesh = inputs.flag("AddMesh");
  if (image_file.empty() && usage_file.empty() && !add_mesh)
    throw UserError("Nothing is asked for; name an ImageFile or a UsageFile, or switch AddMesh on.");
  refuse_inputs(inputs, {"ImageFile", "UsageFile"}, {depth_file, database});

  progress.stage("Reading", 0, 5);
  const cv::Mat depth = read_depth(depth_file);
  Progress opening = progress.part(5, 20), coloring = progress.part(20, 90), meshing = progress.part(90, 98);
  const auto source = open_examples(database, {View{}}, rendering(depth.size()), opening);
  const ColorizeOptions options = options_of(inputs, source->preset());
  const ColorizeResult result = colorize_depth(depth, *source, options, coloring);

  Outcome outcome;
  if (add_mesh) {
    const Camera camera = raster_camera(depth.size(), 1, 0);
    DepthMesh made = depth_to_mesh(depth, {}, camera, {}, meshing);
    const std::string& beside = image_file.empty() ? depth_file : image_file;
    made.mesh.textures = {write_texture(result.color, result.mask, {"", beside, {depth_file, database}})};
    log_value(progress, "texture", made.mesh.textures[0]);
    outcome.layers.push_back({"Colorized", std::move(made.mesh), true, camera});
    outcome.current = 0;
  }
  if (!image_file.empty()) write_image(with_alpha(result.color, result.mask), image_file);
  if (!usage_file.empty()) write_image(usage_picture(result.example), usage_file);
  log_result(result, progress);
  log_value(progress, "seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return outcome;
}

}  // namespace

host::Filter colorize_depth_filter() {
  return {"Examples: Colorize Depth Map",
          slug,
          Menu::Creation,
          "Finds an <b>image-map</b> for a depth map from those of similar objects: every patch of depth and colour is "
          "to be like a patch of the examples. With one example its image-map is morphed onto the new shape."
          "<br><br>See:<br><i>T. Hassner, R. Basri</i><br><b>\"Automatic depth-map colorization\"</b><br>"
          "Eurographics 2006, short papers",
          parameters,
          apply};
}

}  // namespace parts
