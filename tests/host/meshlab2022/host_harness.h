// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <common/mlexception.h>
#include <gtest/gtest.h>

#include "host_plugin.h"

/// How the tests of the plugin class ask MeshLab 2022.02's and later ones; the
/// folder of another generation of hosts has a header of the same name with the
/// same functions.
namespace parts::host::test {

using LengthValue = FloatValue;
using ChoiceValue = IntValue;
#ifdef PARTS_HOST_RENAMED_PARAMETERS
using PointValue = Point3Value;
#else
using PointValue = Point3fValue;
#endif

inline RichParameterList defaults(Plugin& plugin, MeshDocument& document) {
  return plugin.initParameterList(plugin.actions().front(), document);
}

/// @return the sentence of a run that failed, or nothing
inline std::string run(Plugin& plugin, MeshDocument& document, const RichParameterList& list, const GLLogStream&,
                       vcg::CallBackPos* callback) {
  try {
    unsigned int changed = MeshModel::MM_UNKNOWN;
    plugin.applyFilter(plugin.actions().front(), list, document, changed, callback);
    EXPECT_EQ(changed, unsigned(MeshModel::MM_NONE));
    return {};
  } catch (const MLException& failure) {
    return failure.what();
  }
}

inline int raster_count(const MeshDocument& document) { return int(document.rasterNumber()); }

}  // namespace parts::host::test
