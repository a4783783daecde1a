// SPDX-License-Identifier: GPL-3.0-or-later
// MeshLab 2022.02 and later.
#include "runner_host.h"

#include <common/globals.h>
#include <common/mlexception.h>
#include <common/plugins/plugin_manager.h>
#include <common/utilities/load_save.h>
#include <wrap/io_trimesh/io_mask.h>

#include <QFileInfo>

namespace runner {

namespace {

PluginManager& plugins() { return meshlab::pluginManagerInstance(); }

QString& missed_plugins() {
  static QString words;
  return words;
}

}  // namespace

void load_plugins() {
  try {
    plugins().loadPlugins();
  } catch (const MLException& some) {  // the others are there
    missed_plugins() = some.what();
  }
}

QString not_loaded() { return missed_plugins().isEmpty() ? "" : "\n" + missed_plugins(); }

void open_mesh(const QString& file, MeshDocument& document) { meshlab::loadMeshWithStandardParameters(file, document); }

void open_project(const QString& file, MeshDocument& document) { meshlab::loadProject(file, document, &document.Log); }

Action find_filter(const QString& name) {
  QAction* action = plugins().filterAction(name);
  return action ? Action{plugins().getFilterPluginFromAction(action), action} : Action();
}

RichParameterList defaults_of(const Action& filter, MeshDocument& document) {
  return filter.plugin->initParameterList(filter.action, document);
}

bool set_value(const RichParameter& given, MeshDocument&, RichParameterList& list) {
  if (list.getParameterByName(given.name()).value().typeName() != given.value().typeName()) return false;
  list.setValue(given.name(), given.value());
  return true;
}

QString missing_for(const Action& filter, const MeshDocument& document) {
  if (!document.mm()) return filter.plugin->filterArity(filter.action) == Filter::NONE ? "" : "a mesh";
  if (filter.plugin->requiresGLContext(filter.action)) return "a display, so only the program meshlab runs it";
  QStringList missing;
  return filter.plugin->isFilterApplicable(filter.action, *document.mm(), missing) ? "" : missing.join(", ");
}

void apply(const Action& filter, const RichParameterList& values, MeshDocument& document, vcg::CallBackPos* progress) {
  filter.plugin->setLog(&document.Log);
  if (document.mm()) document.mm()->updateDataMask(filter.plugin->getRequirements(filter.action));
  unsigned int changed = MeshModel::MM_UNKNOWN;
  filter.plugin->applyFilter(filter.action, values, document, changed, progress);
}

void save_mesh(const QString& file, int mask, MeshModel& layer, MeshDocument& document) {
  using Mask = vcg::tri::io::Mask;
  const QString ending = QFileInfo(file).suffix().toLower();
  IOPlugin* plugin = plugins().outputMeshPlugin(ending);
  if (!plugin) throw MLException("MeshLab cannot write ." + ending + " files.");
  plugin->setLog(&document.Log);
  int possible = 0, usual = 0;
  plugin->exportMaskCapability(ending, possible, usual);
  mask &= possible;
  plugin->save(ending, file, layer, mask, plugin->initSaveParameter(ending, layer), nullptr);
  layer.setFileName(file);
  if (mask & (Mask::IOM_WEDGTEXCOORD | Mask::IOM_VERTTEXCOORD))
    layer.saveTextures(QFileInfo(file).absolutePath(), -1, &document.Log);
}

void save_project(const QString& file, MeshDocument& document) { meshlab::saveProject(file, document, false); }

}  // namespace runner
