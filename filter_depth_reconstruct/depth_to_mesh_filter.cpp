// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <cmath>
#include <filesystem>

#include "filters.h"
#include "parts/base/error.h"
#include "parts/base/files.h"
#include "parts/host/common.h"
#include "parts/io/raster_io.h"
#include "parts/render/background.h"
#include "parts/render/depth_mesh.h"
#include "parts/render/texture.h"
#include "parts/render/view_image.h"

namespace parts {
namespace {

using namespace host;

constexpr double any = 1e9;

std::vector<Parameter> parameters(const Scene&) {
  return {
      open_file("Depth", {"tif", "tiff", "pfm", "png"}, "Depth",
                "The depth raster: a 32-bit float TIFF or PFM, or a 16-bit PNG. Depth grows away from the camera; 0, "
                "infinity and NaN are background."),
      open_file("Image", {"png", "jpg", "jpeg", "tif", "tiff", "bmp"}, "Image",
                "An image of the same view, in any resolution, that becomes the texture. Empty: no texture."),
      open_file("BackDepth", {"tif", "tiff", "pfm", "png"}, "Back depth",
                "The depth of the farthest surface at each pixel. With it the result is one closed solid. Empty: the "
                "front only."),
      number("DepthScale", 1, -any, any, "Depth scale",
             "World units that one unit of the depth rasters stands for: 0.001 for millimetres that become metres. "
             "Negative for orthographic rasters that grow towards the camera."),
      number("PixelSize", 1, 1e-9, any, "Pixel size",
             "Width of a pixel in world units, in an orthographic image. Not used with a focal length."),
      number("FocalLength", 0, 0, any, "Focal length (pixels)",
             "Of the pinhole camera that saw the depth, whose axis meets the middle of the image. 0: an orthographic "
             "image."),
      length("MaxJump", 0, "Tear at jumps over",
             "Neighbouring pixels whose depths differ by more are not connected (with a back depth: that have more "
             "empty space than this between them). 0: four times the step that three quarters of all neighbours stay "
             "below, but at least six pixels' width."),
      text(
          "Background", "auto", "Background",
          "A depth that stands for \"nothing there\", in the raster's own unit, besides 0, infinity and NaN. auto: the "
          "largest one, where many pixels have that very number, up to the image's border, far behind the rest, as "
          "renderers and sensors write it. none: there is none."),
      save_file("TextureFile", "png", "Texture file",
                "Where the texture is written. Empty: the image itself is the texture where MeshLab can show it as it "
                "is, or else a new file beside the depth raster. Inputs are never replaced."),
  };
}

struct Input {
  cv::Mat depth, back;
  render::RemovedBackground background;
  std::string image_file;
  render::ViewImage view;
};

Input read(const Inputs& inputs, Progress& progress) {
  const std::string depth = inputs.text("Depth"), back = inputs.text("BackDepth");
  const double scale = inputs.number("DepthScale");
  if (depth.empty()) throw UserError("No depth raster is named; choose a float TIFF, a PFM or a 16-bit PNG.");
  if (scale == 0) throw UserError("DepthScale is 0, which makes all depths 0; give another value.");
  const render::BackgroundRule background = render::parse_background(inputs.text("Background"));
  progress.stage("Reading", 0, 20);
  Input in;
  const Poll poll = [&] { progress.at(0); };
  in.depth = io::read_depth(depth, scale, poll);
  if (!back.empty()) in.back = io::read_depth(back, scale, poll);
  in.background = render::remove_background(background, scale, in.depth, in.back);
  in.image_file = inputs.text("Image");
  if (in.image_file.empty()) return in;
  progress.at(0.5);
  in.view = render::read_view_image(in.image_file, in.depth.size());
  return in;
}

/// The file that the mesh names as its texture.
std::string texture_of(const Input& in, const Inputs& inputs, OutputFiles& files) {
  render::TextureTarget target{inputs.text("TextureFile"),
                               inputs.text("Depth"),
                               {inputs.text("Depth"), inputs.text("BackDepth"), in.image_file}};
  if (target.file.empty() && render::shows_as_texture(in.image_file, in.view.image))
    return std::filesystem::absolute(in.image_file).lexically_normal().string();
  return render::add_texture(files, in.view.image.color, in.view.image.mask, target);
}

/// What was assumed of the rasters.
void log_input(const Input& in, Progress& progress) {
  if (in.background.pixels > 0) {
    log_value(progress, "background", in.background.value);
    log_value(progress, "background_pixels", double(in.background.pixels));
  }
  using Held = render::ViewImage::Held;
  if (in.view.held != Held::NotSaid)
    log_value(
        progress, "image_orientation",
        in.view.held == Held::AsStored
            ? "The image's orientation tag is not heeded: it lies on the depth as it is stored, in the same rows."
            : "The image is turned as its orientation tag says; as it is stored it has other proportions than the "
              "depth.");
  constexpr double kWorthSaying = 1e-3;
  if (in.view.off > kWorthSaying)
    log_value(progress, "image_proportions",
              "They differ from the depth's by " + std::to_string(100 * in.view.off).substr(0, 4) +
                  " %; the image is scaled by its width, middle on middle.");
}

Outcome apply(const Inputs& inputs, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const double pixel_size = inputs.number("PixelSize"), focal = inputs.number("FocalLength");
  const Input in = read(inputs, progress);
  const render::Camera camera = render::raster_camera(in.depth.size(), pixel_size, focal);
  Progress meshing = progress.part(20, 95);
  render::DepthMesh result = render::depth_to_mesh(in.depth, in.back, camera, {inputs.length("MaxJump")}, meshing);
  progress.stage("Texture", 95, 100);

  Outcome outcome;
  render::Camera seen = camera;
  if (in.image_file.empty()) {
    result.mesh.wedges.clear();
  } else {
    const cv::Size size = in.view.image.color.size();
    const double finer = double(size.width) / in.depth.cols;
    seen = render::raster_camera(size, pixel_size / finer, focal * finer);
    render::fit_texture(result.mesh, in.depth.size(), size);
    result.mesh.textures = {texture_of(in, inputs, *outcome.files)};
    log_value(progress, "texture", result.mesh.textures[0]);
    const double distance = camera.project(result.mesh.bounds().center()).z();
    outcome.rasters.push_back(
        {std::filesystem::path(in.image_file).filename().string(), result.mesh.textures[0], seen, distance});
  }
  log_input(in, progress);
  log_value(progress, "width", in.depth.cols);
  log_value(progress, "height", in.depth.rows);
  log_value(progress, "max_jump", result.max_jump);
  log_value(progress, "torn_pixels", double(result.torn));
  log_value(progress, "dropped_faces", result.dropped_faces);
  if (!in.back.empty()) log_value(progress, "wall_faces", result.walls);
  if (!in.back.empty()) log_value(progress, "pixels_without_back", double(result.back_before));
  log_value(progress, "vertices", result.mesh.vertex_count());
  log_value(progress, "faces", result.mesh.face_count());
  log_value(progress, "seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  const bool solid = !in.back.empty();
  outcome.layers.push_back(
      {solid ? "Depth solid" : "Depth surface", std::move(result.mesh), true, seen, check_of_depth(solid)});
  outcome.current = 0;
  return outcome;
}

}  // namespace

host::Filter depth_to_mesh_filter() {
  return {"Examples: Depth Map to Textured Mesh",
          "depth_to_mesh",
          Menu::Creation,
          std::string("Turns a depth raster into a mesh, a vertex a pixel: orthographic or through a pinhole camera, "
                      "torn where the depth jumps, with an image of the same view as its texture. With a second "
                      "raster, of the depth behind, front and back become one closed solid. The camera is kept with "
                      "the mesh, and the image becomes a raster layer, so that MeshLab's own filters can project it.") +
              depth_reference,
          parameters,
          apply};
}

}  // namespace parts
