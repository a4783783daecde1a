// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/examples/build_mappings.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>

#include "parts/base/error.h"
#include "parts/examples/class_models.h"
#include "parts/io/class_preset.h"
#include "parts/io/mesh_io.h"
#include "parts/io/mlp_project.h"
#include "parts/io/raster_io.h"
#include "parts/render/depth_mesh.h"
#include "parts/render/mlp_camera.h"

namespace parts::examples {
namespace {

namespace fs = std::filesystem;

std::string shown(double angle) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", angle);
  return text;
}

/// What any file system takes as part of a name; without a mesh file's ending.
std::string safe(const std::string& name) {
  const fs::path ending = fs::path(name).extension();
  const bool file = ending == ".ply" || ending == ".obj" || ending == ".off" || ending == ".stl";
  std::string out;
  for (char c : file ? fs::path(name).stem().string() : name)
    out += std::isalnum(static_cast<unsigned char>(c)) || c == '-' ? c : '_';
  return out.substr(0, 40);
}

/// The output of a run: a folder that grows beside the database's own until all is there.
class Draft {
 public:
  explicit Draft(const fs::path& output)
      : output_(output),
        folder_(output.parent_path() / (output.stem().string() + "_mappings")),
        part_(output.parent_path() / (output.stem().string() + "_mappings.part")) {
    std::error_code error;
    fs::create_directories(part_, error);
    if (error)
      throw UserError("The folder \"" + part_.string() + "\" cannot be made; choose an output that may be written.");
  }
  ~Draft() {
    std::error_code error;
    for (const fs::path& file : files_) fs::remove(part_ / file, error);
    fs::remove(part_, error);  // only if it is empty
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  /// Where to write a file, and where it will be.
  std::string now(const std::string& name) {
    files_.insert(name);
    return (part_ / name).string();
  }
  std::string later(const std::string& name) const { return (folder_ / name).string(); }
  const fs::path& folder() const { return folder_; }
  double free_bytes() const {
    std::error_code error;
    const fs::space_info space = fs::space(part_, error);
    return error ? 0 : double(space.available);
  }

  /// Puts all in place; the files of the database that was there before go.
  void commit(const io::MlpProject& project) {
    std::set<fs::path> old = files_of_old_database();
    std::error_code error;
    fs::create_directories(folder_, error);
    for (const fs::path& file : files_) {
      if (!error) fs::rename(part_ / file, folder_ / file, error);
      old.erase(folder_ / file);
    }
    if (error)
      throw UserError("The folder \"" + folder_.string() + "\" cannot be written; check it and the space left.");
    io::write_mlp(project, output_.string());
    for (const fs::path& file : old) fs::remove(file, error);
  }

 private:
  std::set<fs::path> files_of_old_database() const {
    std::set<fs::path> files;
    std::error_code error;
    if (!fs::exists(output_, error)) return files;
    try {
      const auto add = [&](const fs::path& file) {
        if (file.parent_path() == folder_.lexically_normal()) files.insert(file);
      };
      const io::MlpProject old = io::read_mlp(output_.string());
      for (const io::MlpMesh& mesh : old.meshes) add(mesh.file);
      for (const io::MlpRaster& raster : old.rasters)
        for (const io::MlpPlane& plane : raster.planes) add(plane.file);
    } catch (const UserError&) {  // it could not be read: nothing is known to be its
    }
    return files;
  }

  fs::path output_, folder_, part_;
  std::set<fs::path> files_;
};

void check_output(const std::string& output, const std::string& models) {
  const std::string project = "The output \"" + output + "\" ";
  if (output.empty()) throw UserError("No output is named; give a file that ends in .mlp.");
  const fs::path path(output);
  std::error_code error;
  if (path.extension() != ".mlp") throw UserError(project + "is no MeshLab project; give a file that ends in .mlp.");
  if (fs::is_directory(path, error)) throw UserError(project + "is a folder; give a file that ends in .mlp.");
  if (!fs::exists(path, error)) return;
  if (fs::equivalent(path, models, error)) throw UserError(project + "is the model database; give another name.");
  bool mappings = false;
  try {
    const io::MlpProject old = io::read_mlp(output);
    mappings = std::any_of(old.rasters.begin(), old.rasters.end(),
                           [](const io::MlpRaster& r) { return !r.file_of(io::plane::kDepth).empty(); });
  } catch (const UserError&) {
  }
  if (!mappings) throw UserError(project + "exists and is no mapping database; give another name, or remove it.");
}

void check_space(double bytes, double free) {
  char text[80];
  if (free <= 0 || bytes < free) return;
  std::snprintf(text, sizeof text, "about %.1f GB, and %.1f GB are free", bytes / 1e9, free / 1e9);
  throw UserError("The examples need " + std::string(text) + " on the disk; choose smaller images or fewer views.");
}

/// Stores the planes of an example and lists them as a raster.
io::MlpRaster store(const Example& e, const std::string& stem, Draft& draft, double& bytes) {
  io::MlpRaster raster;
  raster.label = e.object + " " + shown(e.view.yaw) + "," + shown(e.view.pitch);
  raster.camera = render::to_mlp(e.camera, cv::mean(e.depth, e.mask)[0]);
  const auto add = [&](int semantic, const std::string& name, const cv::Mat& raster_data, bool depth) {
    const std::string file = draft.now(name);
    if (depth)
      io::write_depth(raster_data, file);
    else
      io::write_image(raster_data, file);
    std::error_code error;
    bytes += double(fs::file_size(file, error));
    raster.planes.push_back({semantic, draft.later(name)});
  };
  add(io::plane::kColor, stem + ".png", io::with_alpha(e.image, e.mask), false);  // first: MeshLab shows this one
  add(io::plane::kMask, stem + "_mask.png", e.mask, false);
  add(io::plane::kDepth, stem + "_depth.tif", e.depth, true);
  if (!e.back_depth.empty()) add(io::plane::kBackDepth, stem + "_back.tif", e.back_depth, true);
  return raster;
}

/// What the first example shows, as a mesh: MeshLab lists no rasters of a project without meshes.
void add_surface(const Example& e, const std::string& stem, Draft& draft, io::MlpProject& project) {
  try {
    Progress silent;
    render::DepthMesh surface = render::depth_to_mesh(e.depth, {}, e.camera, {}, silent);
    surface.mesh.textures = {draft.now(stem + ".png")};
    io::write_mesh(surface.mesh, draft.now(stem + "_surface.ply"));
    project.meshes.push_back({project.rasters.back().label, draft.later(stem + "_surface.ply")});
  } catch (const UserError&) {  // too small to be a surface
  }
}

}  // namespace

MappingsReport build_mappings(const io::ModelDatabase& database, const std::vector<render::View>& views,
                              const std::string& output, const ExampleOptions& options, Progress& progress) {
  check_output(output, database.path());
  for (const render::View& view : views) render::view_rotation(view, options.up, options.front);
  progress.stage("Reading the models", 0, 30);
  ClassModels models(database, views, options, progress);
  Draft draft(fs::absolute(output));
  check_space(double(models.size()) * double(views.size()) * options.width * options.height * 12, draft.free_bytes());

  progress.stage("Rendering examples", 30, 98);
  MappingsReport report;
  io::MlpProject project;
  double bytes = 0;
  for (int m = 0; m < models.size(); ++m) {
    const int before = report.examples;
    for (std::size_t v = 0; v < views.size(); ++v) {
      progress.at((m + double(v) / double(views.size())) / models.size());
      const Example e = render_example(models.get(m), views[v], models.frame(), options);
      if (cv::countNonZero(e.mask) == 0) {
        progress.log("skipped: " + e.object + " (nothing of it is seen from " + shown(views[v].yaw) + "," +
                     shown(views[v].pitch) + ")");
        continue;
      }
      char number[16];
      std::snprintf(number, sizeof number, "%03d_", m);
      const std::string stem = number + safe(e.object) + "_" + shown(e.view.yaw) + "_" + shown(e.view.pitch);
      project.rasters.push_back(store(e, stem, draft, bytes));
      if (project.rasters.size() == 1) add_surface(e, stem, draft, project);
      ++report.examples;
    }
    report.objects += report.examples > before;
  }
  if (project.rasters.empty()) throw UserError("Nothing is seen of any model; choose larger images or other views.");

  progress.stage("Writing the database", 98, 100);
  io::ClassPreset preset = io::read_class_preset(database.path());
  preset.up = options.up;
  preset.front = options.front;
  draft.commit(project);
  io::write_class_preset(preset, output);
  report.megabytes = bytes / 1e6;
  report.folder = draft.folder().string();
  return report;
}

}  // namespace parts::examples
