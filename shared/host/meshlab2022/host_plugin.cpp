// SPDX-License-Identifier: GPL-3.0-or-later
#include "host_plugin.h"

#include <common/mlexception.h>

#include "parts/host/run.h"

namespace parts::host {

Plugin::Plugin() : filters_(filters()) {
  for (int id = 0; id < int(filters_.size()); ++id) {
    typeList.push_back(id);
    actionList.push_back(new QAction(filterName(id), this));
  }
}

QString Plugin::pluginName() const { return "Shapes from Parts"; }
QString Plugin::vendor() const { return "Shapes from Parts"; }
QString Plugin::filterName(ActionIDType id) const { return QString::fromStdString(filters_[id].name); }
QString Plugin::filterInfo(ActionIDType id) const { return QString::fromStdString(filters_[id].help); }

// Texture makes the host show the current layer's textures after the run.
FilterPlugin::FilterClass Plugin::getClass(const QAction* action) const {
  return FilterClass(menus_of(filter(action).menu) | (textured_ ? Texture : 0));
}

// SINGLE_MESH makes the host refresh the current layer after the run: the result.
// Only what has no arity runs without a mesh.
FilterPlugin::FilterArity Plugin::filterArity(const QAction* action) const {
  return filter(action).menu == Menu::Creation ? NONE : SINGLE_MESH;
}

int Plugin::postCondition(const QAction* action) const { return post_condition_of(filter(action).menu); }

RichParameterList Plugin::initParameterList(const QAction* action, const MeshDocument& document) {
  textured_ = false;
  RichParameterList list;
  declare_parameters(filter(action), document, list);
  return list;
}

std::map<std::string, QVariant> Plugin::applyFilter(const QAction* action, const RichParameterList& list,
                                                    MeshDocument& document, unsigned int& changed,
                                                    vcg::CallBackPos* callback) {
  const auto write = [this](GLLogStream::Levels level, const std::string& line) { log(level, line); };
  const Run done = run(filter(action), document, list, callback, write);
  textured_ = done.textured;
  if (!done.failure.empty()) throw MLException(QString::fromStdString(done.failure));
  changed = unsigned(postCondition(action));
  return {done.figures.begin(), done.figures.end()};
}

}  // namespace parts::host
