// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include "host_plugin.h"

/// How the tests of the plugin class ask MeshLab 2020.09's; the folder of another
/// generation of hosts has a header of the same name with the same functions.
namespace parts::host::test {

using LengthValue = AbsPercValue;
using ChoiceValue = EnumValue;
using PointValue = Point3fValue;

inline RichParameterList defaults(Plugin& plugin, MeshDocument& document) {
  RichParameterList list;
  plugin.initParameterSet(plugin.actions().front(), document, list);
  return list;
}

/// @return the sentence of a run that failed, which must be in the log too, or nothing
inline std::string run(Plugin& plugin, MeshDocument& document, const RichParameterList& list, const GLLogStream& log,
                       vcg::CallBackPos* callback) {
  if (plugin.applyFilter(plugin.actions().front(), document, list, callback)) return {};
  EXPECT_EQ(log.logStringList().last().second, plugin.errorMsg());
  return plugin.errorMsg().toStdString();
}

inline int raster_count(const MeshDocument& document) { return document.rasterList.size(); }

}  // namespace parts::host::test
