// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/host/run.h"

#include <locale>
#include <new>
#include <sstream>

#include "parts/base/error.h"
#include "parts/host/cameras.h"
#include "parts/host/layers.h"
#include "parts/host/parameters.h"
#include "parts/host/results.h"

namespace parts::host {

namespace {

/// Runs a filter and says in one sentence what stopped it; empty when nothing
/// did. No exception may leave a plugin: the host would abort.
template <class Run>
std::string guarded(Run&& run) {
  try {
    run();
    return {};
  } catch (const Cancelled&) {
    return "Cancelled; nothing was changed.";
  } catch (const UserError& error) {
    return error.what();
  } catch (const std::bad_alloc&) {
    return "The memory is used up; choose a lower resolution or meshes with fewer faces.";
  } catch (const std::exception& error) {
    return std::string("The filter met an internal error (") + error.what() +
           "); nothing was changed, please report it with the input.";
  } catch (...) {
    return "The filter met an internal error; nothing was changed, please report it with the input.";
  }
}

/// What a run logs: figures at once, warnings at its end, where they are seen.
class RunLog {
 public:
  explicit RunLog(const WriteLog& write) : write_(write) {}
  ~RunLog() {
    for (const std::string& line : warnings_) write_(GLLogStream::WARNING, line);
  }
  void add(const std::string& line) {
    if (line.rfind("warning: ", 0) == 0)
      warnings_.push_back(line);
    else
      write_(GLLogStream::FILTER, line);
  }

 private:
  const WriteLog& write_;
  std::vector<std::string> warnings_;
};

/// Keeps a line "name: number".
void note_figure(const std::string& line, std::map<std::string, double>& figures) {
  const std::size_t colon = line.find(": ");
  if (colon == std::string::npos) return;
  std::istringstream text(line.substr(colon + 2));
  text.imbue(std::locale::classic());
  double value = 0;
  if (text >> value && text.eof()) figures[line.substr(0, colon)] = value;
}

/// Adds the new layers, all or none, and then does what cannot fail.
void commit(const Outcome& outcome, MeshDocument& document) {
  std::vector<MeshModel*> added;
  std::vector<RasterModel*> rasters;
  const int raster_before = document.rm() ? document.rm()->id() : -1;
  try {
    for (const Outcome::NewLayer& layer : outcome.layers) {
      added.push_back(document.addNewMesh("", QString::fromStdString(layer.name), false));
      write_layer(layer.mesh, *added.back());
      if (layer.camera) set_camera(*layer.camera, *added.back());
    }
    outcome.files->commit();
    for (size_t i = 0; i < added.size(); ++i) api::set_textures(outcome.layers[i].mesh.textures, *added[i]);
    for (const Outcome::NewRaster& raster : outcome.rasters) {
      rasters.push_back(document.addNewRaster());
      write_raster(raster, *rasters.back());
    }
  } catch (...) {
    for (MeshModel* layer : added) api::remove(*layer, document);
    for (RasterModel* raster : rasters) api::remove(*raster, document);
    document.setCurrentRaster(raster_before);
    throw;
  }
  for (const Outcome::Placement& p : outcome.placed) place_layer(p.matrix, p.to_vertices, *p.layer.model());
  for (const Layer& layer : outcome.hidden) document.setVisible(layer.model()->id(), false);
  for (size_t i = 0; i < added.size(); ++i) document.setVisible(added[i]->id(), outcome.layers[i].visible);
  if (outcome.current >= 0) document.setCurrentMesh(added[outcome.current]->id());
}

}  // namespace

Run run(const Filter& filter, MeshDocument& document, const RichParameterList& list, vcg::CallBackPos* callback,
        const WriteLog& log) {
  Run result;
  const auto report = [callback](int percent, const char* stage) {
    // The command line prints the stage as it is, the GUI shows it on one line.
    return !callback || callback(percent, (std::string(stage) + "\n").c_str());
  };
  result.failure = guarded([&] {
    RunLog lines(log);
    Progress progress(report, [&](const std::string& line) {
      note_figure(line, result.figures);
      lines.add(line);
    });
    const RichInputs inputs(parameters_of(filter, scene_of(document)), list, document);
    const bool allow_flaws = !filter.makes_mesh || inputs.flag("AllowFlaws");
    Progress computing = progress.part(0, 97);
    const Outcome outcome = filter.apply(inputs, computing);
    progress.stage("Checking the result", 97, 100);
    check_results(outcome, allow_flaws, progress);
    commit(outcome, document);
    result.textured = outcome.current >= 0 && !outcome.layers[outcome.current].mesh.textures.empty();
  });
  api::forget_texture_files();
  return result;
}

void declare_parameters(const Filter& filter, const MeshDocument& document, RichParameterList& list) {
  declare(parameters_of(filter, scene_of(document)), document, list);
}

int menus_of(Menu menu) {
  using Host = api::FilterPlugin;
  switch (menu) {
    case Menu::Remeshing:
      return Host::Remeshing | Host::Layer;
    case Menu::Deformation:
      return Host::Smoothing | Host::Layer;
    case Menu::Placement:
      return Host::Normal | Host::Layer;
    case Menu::Texturing:
      return Host::VertexColoring | Host::Layer;
    case Menu::Creation:  // alone: 2020.09 offers only this menu in a document without meshes
      return Host::MeshCreation;
  }
  return Host::Generic;
}

int post_condition_of(Menu menu) {
  if (menu != Menu::Placement) return MeshModel::MM_NONE;  // only new layers
  return MeshModel::MM_TRANSFMATRIX | MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL |
         MeshModel::MM_FACEVERT;
}

}  // namespace parts::host
