// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <filesystem>

#include "filters.h"
#include "parameters.h"
#include "parts/base/error.h"
#include "parts/colorize/colorize_depth.h"
#include "parts/examples/examples.h"
#include "parts/host/common.h"
#include "parts/io/raster_io.h"
#include "parts/render/depth_mesh.h"
#include "parts/render/texture.h"
#include "parts/synthesis/usage_picture.h"

namespace parts {
namespace {

using namespace host;

constexpr const char* slug = "colorize_depth";
constexpr int kMostPixels = 1000;  // of the longer side of examples that are rendered

std::vector<Parameter> parameters(const Scene&) {
  std::vector<Parameter> list{
      open_file("Depth", {"tif", "tiff", "pfm", "png"}, "Depth",
                "The depth raster: a 32-bit float TIFF or PFM, or a 16-bit PNG. Depth grows away from the camera; 0, "
                "infinity and NaN are background. Its unit does not matter."),
      open_file("Database", {"mlp", "ply", "obj", "off", "stl"}, "Database",
                "Objects of the same class with colours: a mapping database, or a database of textured or "
                "vertex-coloured models, which are rendered from the front without shading."),
  };
  add_synthesis(list);
  list.push_back(save_file("ImageFile", "png", "Image",
                           "Where the image-map is written, transparent in the background. Empty: not at all."));
  list.push_back(save_file("UsageFile", "png", "Usage picture",
                           "Where a picture of the sources is written: a colour for each example. Empty: not at all."));
  list.push_back(
      flag("AddMesh", true, "Add a mesh",
           "Adds the depth as a mesh with the image-map as its texture, a file beside the image or the depth."));
  return list;
}

/// Models are rendered without shading, about as large as the depth map.
examples::ExampleOptions rendering(cv::Size depth) {
  examples::ExampleOptions o;
  const double scale = std::min(1.0, double(kMostPixels) / std::max(depth.width, depth.height));
  o.width = std::clamp(int(depth.width * scale), 8, kMostPixels);
  o.height = std::clamp(int(depth.height * scale), 8, kMostPixels);
  o.ambient = 1, o.back = false;
  return o;
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
  for (const std::string& file : {image_file, usage_file}) io::check_image_output(file);

  progress.stage("Reading", 0, 5);
  const cv::Mat depth = io::read_depth(depth_file);
  Progress opening = progress.part(5, 20), coloring = progress.part(20, 90), meshing = progress.part(90, 98);
  const auto source = examples::open_examples(database, {render::View{}}, rendering(depth.size()), opening);
  std::vector<std::string> kept = source->files();
  kept.insert(kept.end(), {depth_file, database});
  refuse_inputs(inputs, {"ImageFile", "UsageFile"}, kept);
  colorize::ColorizeOptions options;
  read_synthesis(inputs, source->preset(), slug, options);
  const colorize::ColorizeResult result = colorize::colorize_depth(depth, *source, options, coloring);

  OutputFiles files;
  io::add_image(files, io::with_alpha(result.color, result.mask), image_file);
  io::add_image(files, synthesis::usage_picture(result.example), usage_file);
  Outcome outcome;
  if (add_mesh) {
    const render::Camera camera = render::raster_camera(depth.size(), 1, 0);
    render::DepthMesh made = render::depth_to_mesh(depth, {}, camera, {}, meshing);
    const std::string& beside = image_file.empty() ? depth_file : image_file;
    made.mesh.textures = {render::add_texture(files, result.color, result.mask, {"", beside, kept})};
    log_value(progress, "texture", made.mesh.textures[0]);
    outcome.layers.push_back({"Colorized", std::move(made.mesh), true, camera});
    outcome.current = 0;
  }
  files.commit();
  log_report(result, progress);
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
