// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/host/plugin.h"

#include <new>

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
  using Write = std::function<void(GLLogStream::Levels level, const std::string& line)>;
  explicit RunLog(Write write) : write_(std::move(write)) {}
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
  Write write_;
  std::vector<std::string> warnings_;
};

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
    for (const Outcome::NewRaster& raster : outcome.rasters) {
      rasters.push_back(document.addNewRaster());
      write_raster(raster, *rasters.back());
    }
  } catch (...) {
    for (MeshModel* layer : added) document.delMesh(layer);
    for (RasterModel* raster : rasters) document.delRaster(raster);
    document.setCurrentRaster(raster_before);
    throw;
  }
  for (const Outcome::Placement& p : outcome.placed) place_layer(p.matrix, p.to_vertices, *p.layer.model());
  for (const Layer& layer : outcome.hidden) document.setVisible(layer.model()->id(), false);
  for (size_t i = 0; i < added.size(); ++i) document.setVisible(added[i]->id(), outcome.layers[i].visible);
  if (outcome.current >= 0) document.setCurrentMesh(added[outcome.current]->id());
}

}  // namespace

Plugin::Plugin() : filters_(filters()) {
  for (int id = 0; id < int(filters_.size()); ++id) typeList << id;
  for (FilterIDType id : types()) actionList << new QAction(filterName(id), this);
}

QString Plugin::pluginName() const { return "Shapes from Parts"; }
QString Plugin::filterName(FilterIDType id) const { return QString::fromStdString(filters_[id].name); }
QString Plugin::filterInfo(FilterIDType id) const { return QString::fromStdString(filters_[id].help); }
QString Plugin::filterScriptFunctionName(FilterIDType id) { return QString::fromStdString(filters_[id].slug); }

MeshFilterInterface::FilterClass Plugin::getClass(QAction* action) {
  int menus = Generic;
  switch (filter(action).menu) {
    case Menu::Remeshing:
      menus = Remeshing | Layer;
      break;
    case Menu::Deformation:
      menus = Smoothing | Layer;
      break;
    case Menu::Placement:
      menus = Normal | Layer;
      break;
    case Menu::Texturing:
      menus = VertexColoring | Layer;
      break;
    case Menu::Creation:  // alone: the host offers only this menu in a document without meshes
      menus = MeshCreation;
      break;
  }
  // Makes the host load the current layer's texture files after the run; said
  // only then, as it fails on those of other layers (their names are relative).
  return FilterClass(textured_ ? menus | Texture : menus);
}

// So that the host refreshes the current layer after the run: the result.
MeshFilterInterface::FILTER_ARITY Plugin::filterArity(QAction*) const { return SINGLE_MESH; }

int Plugin::postCondition(QAction* action) const {
  if (filter(action).menu != Menu::Placement) return MeshModel::MM_NONE;  // only new layers
  return MeshModel::MM_TRANSFMATRIX | MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL |
         MeshModel::MM_FACEVERT;
}

void Plugin::initParameterSet(QAction* action, MeshDocument& document, RichParameterList& list) {
  textured_ = false;
  declare(parameters_of(filter(action), scene_of(document)), document, list);
}

bool Plugin::applyFilter(QAction* action, MeshDocument& document, const RichParameterList& list,
                         vcg::CallBackPos* callback) {
  textured_ = false;
  const std::string failure = guarded([&] { run(filter(action), document, list, callback); });
  if (failure.empty()) return true;
  errorMessage = QString::fromStdString(failure);
  Log(GLLogStream::WARNING, failure);  // meshlabserver does not print errorMessage
  return false;
}

void Plugin::run(const Filter& filter, MeshDocument& document, const RichParameterList& list,
                 vcg::CallBackPos* callback) {
  const auto report = [callback](int percent, const char* stage) {
    // meshlabserver prints the stage as it is, the GUI shows it on one line.
    return !callback || callback(percent, (std::string(stage) + "\n").c_str());
  };
  RunLog lines([this](GLLogStream::Levels level, const std::string& line) { Log(level, line); });
  Progress progress(report, [&lines](const std::string& line) { lines.add(line); });
  const RichInputs inputs(parameters_of(filter, scene_of(document)), list, document);
  const bool allow_flaws = !filter.makes_mesh || inputs.flag("AllowFlaws");
  Progress computing = progress.part(0, 97);
  const Outcome outcome = filter.apply(inputs, computing);
  progress.stage("Checking the result", 97, 100);
  check_results(outcome, allow_flaws, progress);
  commit(outcome, document);
  textured_ = outcome.current >= 0 && !outcome.layers[outcome.current].mesh.textures.empty();
}

}  // namespace parts::host
