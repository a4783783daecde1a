// SPDX-License-Identifier: GPL-3.0-or-later
// MeshLab 2020.09.
#include "runner_host.h"

#include <common/meshlabdocumentxml.h>
#include <common/pluginmanager.h>
#include <wrap/io_trimesh/io_mask.h>

#include <QDir>
#include <QFileInfo>
#include <stdexcept>

#include "parts/host/layers.h"
#include "parts/io/mesh_io.h"

namespace runner {

namespace {

using Mask = vcg::tri::io::Mask;

[[noreturn]] void fail(const QString& sentence) { throw std::runtime_error(sentence.toStdString()); }

PluginManager& plugins() {
  static PluginManager manager;
  return manager;
}

/// The host's readers look for textures in the current directory.
class CurrentDirectory {
 public:
  explicit CurrentDirectory(const QString& folder) : before_(QDir::currentPath()) { QDir::setCurrent(folder); }
  CurrentDirectory(const CurrentDirectory&) = delete;
  CurrentDirectory& operator=(const CurrentDirectory&) = delete;
  ~CurrentDirectory() { QDir::setCurrent(before_); }

 private:
  QString before_;
};

/// Normals that the file does not have.
void finish(MeshModel& layer, int mask) {
  if (!(mask & Mask::IOM_VERTNORMAL) && layer.cm.fn > 0)
    vcg::tri::UpdateNormal<CMeshO>::PerVertexNormalizedPerFaceNormalized(layer.cm);
  else
    vcg::tri::UpdateNormal<CMeshO>::PerFaceNormalized(layer.cm);
  vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
}

void read(const QString& file, MeshModel& layer) {
  const QString ending = QFileInfo(file).suffix();
  if (ending.toLower() == "obj") {  // Debian's build of the host's own reader aborts
    const parts::Mesh mesh = parts::io::read_mesh(file.toStdString());
    parts::host::write_layer(mesh, layer);
    parts::host::api::set_textures(mesh.textures, layer);
    return;
  }
  MeshIOInterface* plugin = plugins().allKnowInputFormats.value(ending.toLower());
  if (!plugin) fail("MeshLab cannot read ." + ending + " files.");
  const CurrentDirectory beside(QFileInfo(file).absolutePath());
  RichParameterList options;
  plugin->initPreOpenParameter(ending, file, options);
  int mask = 0;
  if (!plugin->open(ending, file, layer, mask, options))
    fail("The mesh " + file + " cannot be read: " + plugin->errorMsg());
  finish(layer, mask);
}

}  // namespace

void load_plugins() {
  static RichParameterList settings;
  plugins().loadPlugins(settings);
}

QString not_loaded() { return {}; }

void open_mesh(const QString& file, MeshDocument& document) {
  if (!QFileInfo(file).isReadable()) fail("The mesh " + file + " cannot be read.");
  read(file, *document.addNewMesh(file, QFileInfo(file).fileName()));
}

void open_project(const QString& file, MeshDocument& document) {
  const CurrentDirectory beside(QFileInfo(file).absolutePath());
  std::map<int, MLRenderingData> shown;
  const int before = document.meshList.size();
  if (!MeshDocumentFromXML(document, file, QFileInfo(file).suffix().toLower() == "mlb", shown))
    fail("The project " + file + " cannot be read.");
  for (MeshModel* layer : document.meshList.mid(before)) {
    const Matrix44m matrix = layer->cm.Tr;  // reading the mesh resets it
    read(layer->fullName(), *layer);
    layer->cm.Tr = matrix;
  }
}

Action find_filter(const QString& name) {
  QAction* action = plugins().actionFilterMap.value(name);
  return action ? Action{qobject_cast<Filter*>(action->parent()), action} : Action();
}

RichParameterList defaults_of(const Action& filter, MeshDocument& document) {
  RichParameterList list;
  filter.plugin->initParameterSet(filter.action, document, list);
  return list;
}

bool set_value(const RichParameter& given, MeshDocument& document, RichParameterList& list) {
  const RichParameter& declared = list.getParameterByName(given.name());
  const auto* layer = dynamic_cast<const RichMesh*>(&given);
  if (layer && dynamic_cast<const RichMesh*>(&declared)) {  // the script gives an index
    const int index = layer->meshindex;
    if (index < 0 || index >= document.meshList.size())
      fail(given.name() + " is the layer " + QString::number(index) + ", and there are " +
           QString::number(document.meshList.size()) + ", counted from 0.");
    list.setValue(given.name(), MeshValue(&document, index));
    return true;
  }
  if (declared.value().typeName() != given.value().typeName()) return false;
  list.setValue(given.name(), given.value());
  return true;
}

// Preconditions are not looked at, as meshlabserver does it: this host's are those of its menus.
QString missing_for(const Action& filter, const MeshDocument&) {
  // The plugins that draw end the program where there is nothing to draw on.
  static const QStringList drawing = {"AmbientOcclusionPlugin",
                                      "FilterColorProjectionPlugin",
                                      "FilterImgPatchParamPlugin",
                                      "FilterMutualGlobal",
                                      "FilterMutualInfoPlugin",
                                      "ExtraSampleGPUPlugin",
                                      "SdfGpuPlugin"};
  const bool draws = drawing.contains(filter.action->parent()->metaObject()->className());
  return draws ? "a display; run the script by meshlabserver" : "";
}

void apply(const Action& filter, const RichParameterList& values, MeshDocument& document, vcg::CallBackPos* progress) {
  filter.plugin->setLog(&document.Log);
  if (document.mm()) document.mm()->updateDataMask(filter.plugin->getRequirements(filter.action));
  if (filter.plugin->applyFilter(filter.action, document, values, progress)) return;
  fail(filter.plugin->errorMsg());
}

void save_mesh(const QString& file, int mask, MeshModel& layer, MeshDocument& document) {
  QString ending = QFileInfo(file).suffix().toLower();
  MeshIOInterface* plugin = plugins().allKnowOutputFormats.value(ending);
  if (!plugin) fail("MeshLab cannot write ." + ending + " files.");
  plugin->setLog(&document.Log);
  int possible = 0, usual = 0;
  plugin->GetExportMaskCapability(ending, possible, usual);
  RichParameterList options;
  plugin->initSaveParameter(ending, layer, options);
  if (!plugin->save(ending, file, layer, mask & possible, options)) fail("The mesh " + file + " cannot be written.");
  layer.setFileName(file);
}

void save_project(const QString& file, MeshDocument& document) {
  if (!MeshDocumentToXMLFile(document, file, false, false, QFileInfo(file).suffix().toLower() == "mlb"))
    fail("The project " + file + " cannot be written.");
}

}  // namespace runner
