// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/examples/build_mappings.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <vector>

#include "parts/base/error.h"
#include "parts/base/files.h"
#include "parts/examples/class_models.h"
#include "parts/io/class_preset.h"
#include "parts/io/manifest.h"
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

/// The files of a run, which come to light once all of them are there.
class Draft {
 public:
  /// @param inputs  files that are never replaced or removed
  Draft(const fs::path& output, const std::vector<std::string>& inputs)
      : output_(output), folder_(output.parent_path() / (output.stem().string() + "_mappings")), inputs_(inputs) {
    files_.make_folder(folder_);
    find_older();
  }

  /// Where a file of that name will be. @throws UserError  it is the user's
  std::string place(const std::string& name) {
    const fs::path path = folder_ / name;
    std::error_code error;
    const bool there = fs::exists(path, error);
    if (there && older_.count(name) == 0) {  // another run may have put it there meanwhile
      const FolderLock alone(folder_of(output_));
      find_older();
    }
    if (there && (older_.count(name) == 0 || is_input(path)))
      throw UserError("The file \"" + path.string() +
                      "\" is not of an older database and would be replaced; move it, or give another output.");
    names_.insert(name);
    return path.string();
  }
  OutputFiles& files() { return files_; }
  const fs::path& folder() const { return folder_; }
  double free_bytes() const {
    std::error_code error;
    const fs::space_info space = fs::space(folder_, error);
    return error ? 0 : double(space.available);
  }

  /// Puts all in place; what only the older database had goes.
  void commit(const io::MlpProject& project, const io::ClassPreset& preset) {
    files_.lock(folder_of(output_));
    find_older();
    for (const std::string& name : manifest_)
      if (names_.count(name) == 0 && !is_input(folder_ / name)) files_.remove(folder_ / name);
    io::add_manifest(files_, names_, folder_);
    io::add_class_preset(files_, preset, output_.string());
    io::add_mlp(files_, project, output_.string());
    files_.commit();
  }

 private:
  /// Files of an older database: what its manifest names, or the images of one
  /// that was made before there were manifests, which are replaced but not removed.
  void find_older() {
    const std::optional<io::Manifest> manifest = io::read_manifest(folder_);
    manifest_ = manifest.value_or(io::Manifest());
    older_.insert(manifest_.begin(), manifest_.end());
    if (manifest || !fs::exists(output_)) return;
    try {
      for (const io::MlpRaster& raster : io::read_mlp(output_.string()).rasters)
        for (const io::MlpPlane& plane : raster.planes) {
          const fs::path file = plane.file;
          if (folder_of(file).lexically_normal() != folder_.lexically_normal()) continue;
          older_.insert(file.filename().string());
          older_.insert(file.stem().string() + "_surface.ply");
        }
    } catch (const UserError&) {  // it could not be read: nothing is known to be its
    }
  }
  bool is_input(const fs::path& file) const {
    std::error_code error;
    return std::any_of(inputs_.begin(), inputs_.end(),
                       [&](const std::string& i) { return fs::equivalent(i, file, error); });
  }

  fs::path output_, folder_;
  std::vector<std::string> inputs_;
  io::Manifest manifest_, names_;
  std::set<std::string> older_;
  OutputFiles files_;
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
  if (free <= 0 || bytes < free) return;
  throw UserError("The examples need about " + readable_size(bytes) + " on the disk, and " + readable_size(free) +
                  " are free; choose smaller images or fewer views.");
}

/// Stores the planes of an example and lists them as a raster.
io::MlpRaster store(const Example& e, const std::string& stem, Draft& draft, double& bytes) {
  io::MlpRaster raster;
  raster.label = e.object + " " + shown(e.view.yaw) + "," + shown(e.view.pitch);
  raster.camera = render::to_mlp(e.camera, cv::mean(e.depth, e.mask)[0]);
  const auto add = [&](int semantic, const std::string& name, const cv::Mat& raster_data, bool depth) {
    const std::string file = draft.place(name);
    const double before = draft.files().bytes();
    (depth ? io::add_depth : io::add_image)(draft.files(), raster_data, file);
    bytes += draft.files().bytes() - before;
    raster.planes.push_back({semantic, file});
  };
  add(io::plane::kColor, stem + ".png", io::with_alpha(e.image, e.mask), false);  // first: MeshLab shows this one
  add(io::plane::kMask, stem + "_mask.png", e.mask, false);
  add(io::plane::kDepth, stem + "_depth.tif", e.depth, true);
  if (!e.back_depth.empty()) add(io::plane::kBackDepth, stem + "_back.tif", e.back_depth, true);
  return raster;
}

/// What the first example shows, as a mesh: MeshLab lists no rasters of a project without meshes.
void add_surface(const Example& e, const std::string& stem, Draft& draft, io::MlpProject& project) {
  render::DepthMesh surface;
  try {
    Progress silent;
    surface = render::depth_to_mesh(e.depth, {}, e.camera, {}, silent);
  } catch (const UserError&) {  // too small to be a surface
    return;
  }
  surface.mesh.textures = {stem + ".png"};
  const std::string file = draft.place(stem + "_surface.ply");
  io::add_mesh(draft.files(), surface.mesh, file);
  project.meshes.push_back({project.rasters.back().label, file});
}

/// The class's preset for the new database. What users set in the preset of an older one stays.
io::ClassPreset preset_for(const std::string& output, const std::string& models, const ExampleOptions& options,
                           Progress& progress) {
  io::ClassPreset preset = io::read_class_preset(models);
  const io::ClassPreset older = io::read_class_preset(output);
  for (const auto& [filter, values] : older.values)
    for (const auto& [name, value] : values) preset.values[filter][name] = value;
  preset.up = options.up, preset.front = options.front;
  if ((older.up && *older.up != options.up) || (older.front && *older.front != options.front))
    progress.log("preset_changed: Up and Front of \"" + io::class_preset_path(output) +
                 "\" are now those that the models were seen with");
  return preset;
}

}  // namespace

MappingsReport build_mappings(const io::ModelDatabase& database, const std::vector<render::View>& views,
                              const std::string& output, const ExampleOptions& options, Progress& progress) {
  check_output(output, database.path());
  for (const render::View& view : views) render::view_rotation(view, options.up, options.front);
  progress.stage("Reading the models", 0, 30);
  ClassModels models(database, views, options, progress);
  Draft draft(fs::absolute(output), models.files());
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
  draft.commit(project, preset_for(output, database.path(), options, progress));
  report.megabytes = bytes / 1e6;
  report.folder = draft.folder().string();
  return report;
}

}  // namespace parts::examples
