// SPDX-License-Identifier: GPL-3.0-or-later
#include "host_plugin.h"

#include "parts/host/run.h"

namespace parts::host {

Plugin::Plugin() : filters_(filters()) {
  for (int id = 0; id < int(filters_.size()); ++id) typeList << id;
  for (FilterIDType id : types()) actionList << new QAction(filterName(id), this);
}

QString Plugin::pluginName() const { return "Shapes from Parts"; }
QString Plugin::filterName(FilterIDType id) const { return QString::fromStdString(filters_[id].name); }
QString Plugin::filterInfo(FilterIDType id) const { return QString::fromStdString(filters_[id].help); }
QString Plugin::filterScriptFunctionName(FilterIDType id) { return QString::fromStdString(filters_[id].slug); }

// Texture makes the host load the current layer's texture files after the run;
// said only then, as it fails on those of other layers (their names are relative).
MeshFilterInterface::FilterClass Plugin::getClass(QAction* action) {
  return FilterClass(menus_of(filter(action).menu) | (textured_ ? Texture : 0));
}

// So that the host refreshes the current layer after the run: the result.
MeshFilterInterface::FILTER_ARITY Plugin::filterArity(QAction*) const { return SINGLE_MESH; }

int Plugin::postCondition(QAction* action) const { return post_condition_of(filter(action).menu); }

void Plugin::initParameterSet(QAction* action, MeshDocument& document, RichParameterList& list) {
  textured_ = false;
  declare_parameters(filter(action), document, list);
}

bool Plugin::applyFilter(QAction* action, MeshDocument& document, const RichParameterList& list,
                         vcg::CallBackPos* callback) {
  const auto log = [this](GLLogStream::Levels level, const std::string& line) { Log(level, line); };
  const Run done = run(filter(action), document, list, callback, log);
  textured_ = done.textured;
  if (done.failure.empty()) return true;
  errorMessage = QString::fromStdString(done.failure);
  Log(GLLogStream::WARNING, done.failure);  // meshlabserver does not print errorMessage
  return false;
}

}  // namespace parts::host
