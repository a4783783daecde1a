// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "host_api.h"
#include "parts/host/filter.h"

namespace parts::host {

/// The plugin interface of MeshLab 2022.02 and later over a table of filters.
/// Compiled into every plugin of the suite.
class Plugin : public QObject, public ::FilterPlugin {
  Q_OBJECT
  MESHLAB_PLUGIN_IID_EXPORTER(FILTER_PLUGIN_IID)
  Q_INTERFACES(FilterPlugin)

 public:
  Plugin();
  QString pluginName() const override;
  QString vendor() const override;
  QString filterName(ActionIDType id) const override;
  QString filterInfo(ActionIDType id) const override;
  FilterClass getClass(const QAction* action) const override;
  FilterArity filterArity(const QAction* action) const override;
  int postCondition(const QAction* action) const override;
  RichParameterList initParameterList(const QAction* action, const MeshDocument& document) override;
  /// @return the figures that the filter has logged, for PyMeshLab's users
  /// @throws MLException  what the user did wrong, in one sentence
  std::map<std::string, QVariant> applyFilter(const QAction* action, const RichParameterList& list,
                                              MeshDocument& document, unsigned int& changed,
                                              vcg::CallBackPos* callback) override;

 private:
  const Filter& filter(const QAction* action) const { return filters_[ID(action)]; }

  std::vector<Filter> filters_;
  bool textured_ = false;  ///< the last run made a textured layer
};

}  // namespace parts::host
