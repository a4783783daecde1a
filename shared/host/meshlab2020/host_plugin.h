// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "host_api.h"
#include "parts/host/filter.h"

namespace parts::host {

/// The plugin interface of MeshLab 2020.09 over a table of filters. Compiled
/// into every plugin of the suite.
class Plugin : public QObject, public MeshFilterInterface {
  Q_OBJECT
  MESHLAB_PLUGIN_IID_EXPORTER(MESH_FILTER_INTERFACE_IID)
  Q_INTERFACES(MeshFilterInterface)

 public:
  Plugin();
  QString pluginName() const override;
  QString filterName(FilterIDType id) const override;
  QString filterInfo(FilterIDType id) const override;
  QString filterScriptFunctionName(FilterIDType id) override;
  FilterClass getClass(QAction* action) override;
  FILTER_ARITY filterArity(QAction* action) const override;
  int postCondition(QAction* action) const override;
  void initParameterSet(QAction* action, MeshDocument& document, RichParameterList& list) override;
  bool applyFilter(QAction* action, MeshDocument& document, const RichParameterList& list,
                   vcg::CallBackPos* callback) override;

 private:
  const Filter& filter(QAction* action) const { return filters_[ID(action)]; }

  std::vector<Filter> filters_;
  bool textured_ = false;  ///< the last run made a textured layer
};

}  // namespace parts::host
