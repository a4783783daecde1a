// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "host_api.h"

/// What the command line asks of the host. Each generation of hosts has a folder
/// with these functions. Failures are exceptions with a sentence for the user.
namespace runner {

void load_plugins();
/// The host's words on plugins that could not be loaded; empty where all were.
QString not_loaded();

/// Adds the layers of a mesh file. @param file  absolute
void open_mesh(const QString& file, MeshDocument& document);
/// Adds the layers of a MeshLab project. @param file  absolute
void open_project(const QString& file, MeshDocument& document);

using Filter = parts::host::api::FilterPlugin;
struct Action {
  Filter* plugin = nullptr;  ///< null where there is no such filter
  QAction* action = nullptr;
};
Action find_filter(const QString& name);
/// The filter's declared defaults in this document.
RichParameterList defaults_of(const Action& filter, MeshDocument& document);
/// Sets a value from a script. @return false where it is of another type
bool set_value(const RichParameter& given, MeshDocument& document, RichParameterList& list);
/// What the filter needs that is not there; nothing where it can run.
QString missing_for(const Action& filter, const MeshDocument& document);
void apply(const Action& filter, const RichParameterList& values, MeshDocument& document, vcg::CallBackPos* progress);

/// @param file  absolute
/// @param mask  what is saved besides the surface, bits of vcg::tri::io::Mask
void save_mesh(const QString& file, int mask, MeshModel& layer, MeshDocument& document);
/// @param file  absolute
void save_project(const QString& file, MeshDocument& document);

}  // namespace runner
