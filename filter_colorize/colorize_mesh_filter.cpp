// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <sstream>

#include "filters.h"
#include "parameters.h"
#include "parts/base/error.h"
#include "parts/base/files.h"
#include "parts/base/memory.h"
#include "parts/colorize/colorize_mesh.h"
#include "parts/host/common.h"
#include "parts/io/raster_io.h"
#include "parts/render/atlas.h"
#include "parts/render/surface_color.h"
#include "parts/render/texture.h"
#include "parts/synthesis/usage_picture.h"
#include "recent_models.h"

namespace parts {
namespace {

using namespace host;

constexpr const char *slug = "colorize_mesh", *around = "0,0; 60,0; 120,0; 180,0; -120,0; -60,0; 0,75; 0,-75";
enum Target { kTexture, kVertexColor };
enum Keep { kNothing, kSelectedFaces };

std::vector<Parameter> parameters(const Scene&) {
  const colorize::ColorizeMeshOptions o;
  std::vector<Parameter> list{
      current_layer("Mesh", "Mesh", "The surface that is to be coloured. It stays as it is."),
      open_file("Database", {"mlp", "ply", "obj", "off", "stl"}, "Database",
                "Textured or vertex-coloured models of the same class: a project or a folder, for which any file in it "
                "stands."),
      text("Views", around, "Views",
           "From where the surface is seen and coloured: yaw,pitch in degrees, separated by semicolons. What no view "
           "sees follows the most similar model."),
      point(
          "Up", o.up, "Up",
          "The direction in which the mesh stands. At their defaults, Up and Front are those of the class, or the axes "
          "along which the mesh is much more like it."),
      point("Front", o.front, "Front", "The direction in which it faces; as for Up."),
      integer("Width", 300, 8, 4096, "Width (pixels)", "Columns of the views: more give finer colours."),
      integer("Height", 400, 8, 4096, "Height (pixels)", "Rows of the views."),
      choice("Target", kTexture, {"Texture", "Vertex colour"}, "Target",
             "A texture in the mesh's own texture coordinates, or in new ones where it has none that would do; or "
             "colours of vertices."),
      save_file("TextureFile", "png", "Texture",
                "Where the texture is written. Empty: NAME_texture.png in the current folder, after the layer's name."),
      integer("TextureSize", 1024, 16, 16384, "Texture size (texels)", "Rows and columns of the texture."),
  };
  add_synthesis(list);
  list.push_back(choice("Keep", kNothing, {"Nothing", "Selected faces"}, "Keep the colours of",
                        "Faces whose own colours stay; those of the others are found such that they go with them."));
  list.push_back(flag("Align", true, "Align",
                      "Moves the mesh onto the most similar model for the comparison, where they are nearly aligned "
                      "already. The mesh itself is not moved."));
  list.push_back(
      save_file("UsageFile", "png", "Usage picture",
                "Where a picture of the views is written with a colour for each example. Empty: not at all."));
  return list;
}

colorize::ColorizeMeshOptions options_of(const Inputs& inputs, const Mesh& mesh, const io::ClassPreset& preset) {
  colorize::ColorizeMeshOptions o;
  const examples::ExampleOptions fallback;
  read_synthesis(inputs, preset, slug, o);
  o.views = render::parse_views(inputs.text("Views"));
  o.up = class_direction(inputs, "Up", fallback.up, preset.up);
  o.front = class_direction(inputs, "Front", fallback.front, preset.front);
  o.rendering.up = preset.up.value_or(fallback.up);
  o.rendering.front = preset.front.value_or(fallback.front);
  o.find_frame = o.up == o.rendering.up && o.front == o.rendering.front;
  o.rendering.width = inputs.integer("Width");
  o.rendering.height = inputs.integer("Height");
  o.rendering.light.ambient = 1, o.rendering.back = false;
  o.align = inputs.flag("Align");
  if (inputs.choice("Keep") == kSelectedFaces) {
    if (std::count(mesh.face_selected.begin(), mesh.face_selected.end(), 1) == 0)
      throw UserError("No face is selected whose colours could be kept; select some, or set Keep to Nothing.");
    if (!render::has_colors(mesh, render::load_textures(mesh)))
      throw UserError("The mesh has no colours that could be kept; set Keep to Nothing.");
    o.keep = mesh.face_selected;
  }
  return o;
}

void check_texture_size(int size) {
  constexpr double kBytes = 40;  // a texel while it is found
  check_memory("A texture of " + std::to_string(size) + " x " + std::to_string(size), kBytes * size * size,
               available_memory(), "choose a smaller TextureSize");
}

/// The mesh with a texture: its picture, its file.
void add_texture(Mesh& mesh, const colorize::MeshColors& colors, const Inputs& inputs,
                 const std::vector<std::string>& kept, OutputFiles& files, Progress& progress) {
  const int size = inputs.integer("TextureSize");
  const std::string flaw = render::texture_coordinates_flaw(mesh, size);
  const Mesh before = mesh;
  if (!flaw.empty()) {
    render::Atlas atlas = render::make_atlas(mesh, size);
    log_value(progress, "own_texture_coordinates", flaw);
    log_value(progress, "charts", atlas.charts);
    mesh.wedges = std::move(atlas.wedges);
  }
  const colorize::BakedTexture baked = colorize::bake_texture(before, mesh.wedges, size, colors, 0);
  std::string name = std::filesystem::path(inputs.layer("Mesh").name()).filename().string();
  if (name.empty()) name = "colorized";
  mesh.textures = {render::add_texture(files, baked.color, baked.mask, {inputs.text("TextureFile"), name, kept})};
  mesh.vertex_color.clear(), mesh.face_color.clear();
  log_value(progress, "texture", mesh.textures[0]);
}

std::string axis(const Vec3& v) {
  std::ostringstream text;
  text << v.x() << " " << v.y() << " " << v.z();
  return text.str();
}

Outcome apply(const Inputs& inputs, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const std::string database = inputs.text("Database"), usage_file = inputs.text("UsageFile");
  if (database.empty()) throw UserError("No database is named; choose a project or a folder of coloured models.");
  io::check_image_output(inputs.text("TextureFile"));
  io::check_image_output(usage_file);
  if (inputs.choice("Target") == kTexture) check_texture_size(inputs.integer("TextureSize"));
  Mesh mesh = surface_of(inputs.layer("Mesh"));
  Progress opening = progress.part(0, 20), coloring = progress.part(20, 90);
  opening.stage("Reading the models", 0, 100);
  const io::ModelDatabase listed(database, opening);
  const colorize::ColorizeMeshOptions options = options_of(inputs, mesh, io::read_class_preset(listed.path()));
  const auto models = recent_models(listed, options.views, options.rendering, opening);
  std::vector<std::string> kept = models->files();
  kept.insert(kept.end(), mesh.textures.begin(), mesh.textures.end());
  refuse_inputs(inputs, {"TextureFile", "UsageFile"}, kept);

  const colorize::MeshColors colors = colorize::colorize_mesh(mesh, *models, options, coloring);
  progress.stage("Writing", 90, 100);
  Outcome outcome;
  OutputFiles& files = *outcome.files;
  if (!usage_file.empty()) io::add_image(files, synthesis::usage_picture(colors.example), usage_file);
  if (inputs.choice("Target") == kTexture) {
    add_texture(mesh, colors, inputs, kept, files, progress);
  } else {
    mesh.vertex_color = colorize::vertex_colors(colors);
    mesh.wedges.clear(), mesh.textures.clear(), mesh.face_color.clear();
  }
  log_report(colors, progress);
  log_value(progress, "seen", colors.seen);
  if (colors.turned) {
    log_value(progress, "up", axis(colors.turned->up));
    log_value(progress, "front", axis(colors.turned->front));
  }
  if (!colors.continued)
    log_value(
        progress, "warning",
        "The colours of what no view sees could not be fitted to those around; they are the most similar model's.");
  log_value(progress, "seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  if (!colors.trusted()) log_value(progress, "warning", doubt(colors));
  outcome.layers.push_back({layer_name(colors), std::move(mesh), true, {}, {{inputs.layer("Mesh")}}});
  outcome.current = 0;
  outcome.hidden = {inputs.layer("Mesh")};
  return outcome;
}

}  // namespace

host::Filter colorize_mesh_filter() {
  return {"Examples: Colorize Mesh",
          slug,
          Menu::Texturing,
          "Finds colours for a whole mesh from <b>coloured models of its class</b>: several views are coloured "
          "together, so that they agree wherever they show the same point. The result is a copy with a texture or "
          "vertex colours.<br><br>See:<br><i>T. Hassner, R. Basri</i><br><b>\"Automatic depth-map "
          "colorization\"</b><br>Eurographics 2006, short papers",
          parameters,
          apply};
}

}  // namespace parts
