// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>

#include "filters.h"
#include "parts/examples/build_mappings.h"
#include "parts/host/common.h"

namespace parts {
namespace {

using namespace host;

std::vector<Parameter> parameters(const Scene&) {
  const examples::ExampleOptions options;
  return {
      open_file(
          "Models", {"mlp", "ply", "obj", "off", "stl"}, "Models",
          "The models of the class: a MeshLab project (.mlp), or a folder of .ply, .obj, .off and .stl files, for "
          "which any of them stands. Textures and vertex colours are shown."),
      save_file("Output", "mlp", "Database",
                "The project to write (.mlp). The images go into a folder beside it, named after it."),
      integer("Width", options.width, 8, 8192, "Width (pixels)", "Columns of the images."),
      integer("Height", options.height, 8, 8192, "Height (pixels)", "Rows of the images."),
      text(
          "Views", "0,0", "Views",
          "From where the models are seen: yaw,pitch in degrees, separated by semicolons, as in \"0,0; 30,0; -30,15\". "
          "Positive yaw shows the model's left side, positive pitch looks from above."),
      point("Up", options.up, "Up",
            "The direction in which the models stand. Where the class's preset has another one, this default gives way "
            "to it."),
      point("Front", options.front, "Front", "The direction in which the models face; as for Up."),
      point(
          "Light", options.light.direction, "Light",
          "The direction to the light as the camera sees it: x to the right, y up, z towards the viewer. Choose it as "
          "in the images that are to be reconstructed."),
      number("Ambient", options.light.ambient, 0, 1, "Ambient light", "The share of light that comes from everywhere."),
      flag("BackSide", options.back, "Back side",
           "Stores the depth of the farthest surface too, from which back sides are reconstructed."),
  };
}

Outcome apply(const Inputs& inputs, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  examples::ExampleOptions options;
  options.width = inputs.integer("Width");
  options.height = inputs.integer("Height");
  const std::vector<render::View> views = render::parse_views(inputs.text("Views"));
  options.light.direction = inputs.point("Light");
  options.light.ambient = inputs.number("Ambient");
  options.back = inputs.flag("BackSide");
  const io::ModelDatabase models(inputs.text("Models"), progress);
  const io::ClassPreset preset = io::read_class_preset(models.path());
  const examples::ExampleOptions fallback;
  options.up = class_direction(inputs, "Up", fallback.up, preset.up);
  options.front = class_direction(inputs, "Front", fallback.front, preset.front);

  const examples::MappingsReport report =
      examples::build_mappings(models, views, inputs.text("Output"), options, progress);
  log_value(progress, "objects", report.objects);
  log_value(progress, "views", double(views.size()));
  log_value(progress, "examples", report.examples);
  log_value(progress, "megabytes", report.megabytes);
  log_value(progress, "folder", report.folder);
  log_value(progress, "seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return {};
}

}  // namespace

host::Filter build_mappings_filter() {
  return {"Examples: Build Mapping Database",
          "build_mappings",
          Menu::Creation,
          std::string("Renders the models of a class from some views and stores what is seen, with its depth, as a "
                      "<b>mapping database</b>: a project that opens in MeshLab and from which the depth of an image "
                      "is reconstructed. All models are framed alike. Models need not be stored as examples: the "
                      "reconstruction can render them as well, from any view.") +
              depth_reference,
          parameters,
          apply,
          false};
}

}  // namespace parts
