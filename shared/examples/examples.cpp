// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/examples/examples.h"

#include <algorithm>
#include <filesystem>

#include "parts/base/error.h"
#include "parts/examples/class_models.h"
#include "parts/examples/stored_examples.h"
#include "parts/io/mlp_project.h"

namespace parts::examples {
namespace {

class RenderedExamples : public ExampleSource {
 public:
  RenderedExamples(const io::ModelDatabase& database, const std::vector<render::View>& views,
                   const ExampleOptions& options, Progress& progress)
      : preset_(io::read_class_preset(database.path())),
        options_(standing(options, preset_)),
        models_(database, views, options_, progress) {}

  int size() const override { return models_.size(); }
  const std::string& name(int object) const override { return models_.name(object); }
  cv::Size image_size() const override { return {options_.width, options_.height}; }
  std::vector<render::View> views(int) const override { return {}; }
  Example get(int object, const render::View& view) override {
    return render_example(models_.get(object), view, models_.frame(), options_);
  }
  std::optional<Light> light() const override { return Light{options_.light, options_.ambient}; }
  void set_light(const Light& light) override { options_.light = light.direction, options_.ambient = light.ambient; }
  std::vector<std::string> files() const override { return models_.files(); }
  const io::ClassPreset& preset() const override { return preset_; }

 private:
  /// The class says how its models stand.
  static ExampleOptions standing(ExampleOptions options, const io::ClassPreset& preset) {
    options.up = preset.up.value_or(options.up);
    options.front = preset.front.value_or(options.front);
    return options;
  }

  io::ClassPreset preset_;
  ExampleOptions options_;
  ClassModels models_;
};

/// The views and those around them that a search for the view may come to.
std::vector<render::View> with_neighbours(const std::vector<render::View>& views) {
  std::vector<render::View> all;
  for (const render::View& v : views)
    for (double yaw : {-35., 0., 35.})
      for (double pitch : {-25., 0., 25.})
        all.push_back({v.yaw + yaw, std::clamp(v.pitch + pitch, std::min(v.pitch, -90.), std::max(v.pitch, 90.))});
  return all;
}

}  // namespace

std::unique_ptr<ExampleSource> render_examples(const io::ModelDatabase& database,
                                               const std::vector<render::View>& views, const ExampleOptions& options,
                                               Progress& progress) {
  return std::make_unique<RenderedExamples>(database, with_neighbours(views), options, progress);
}

std::unique_ptr<ExampleSource> open_examples(const std::string& path, const std::vector<render::View>& views,
                                             const ExampleOptions& options, Progress& progress) {
  std::error_code error;
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  if (extension == ".mlp" && std::filesystem::is_regular_file(path, error)) {
    const io::MlpProject project = io::read_mlp(path);
    if (std::any_of(project.rasters.begin(), project.rasters.end(),
                    [](const io::MlpRaster& r) { return !r.file_of(io::plane::kDepth).empty(); }))
      return open_mapping_database(path, progress);
    if (project.meshes.empty())
      throw UserError("The project \"" + path +
                      "\" holds neither models nor rasters with depth; choose another database.");
  }
  return render_examples(io::ModelDatabase(path, progress), views, options, progress);
}

}  // namespace parts::examples
