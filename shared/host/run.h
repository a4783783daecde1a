// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <string>

#include "host_api.h"
#include "parts/host/filter.h"

/// What the plugin classes of all hosts share.
namespace parts::host {

/// What became of a run.
struct Run {
  std::string failure;                    ///< one sentence; empty where it has succeeded
  std::map<std::string, double> figures;  ///< what was logged as "name: number", the last of each name
  bool textured = false;                  ///< the layer that became the current one has textures
};

/// Writes a line to the host's log.
using WriteLog = std::function<void(GLLogStream::Levels level, const std::string& line)>;

/// Runs a filter and commits its outcome, all or nothing. Throws nothing.
/// @param list  values; those that it leaves out are the defaults
Run run(const Filter& filter, MeshDocument& document, const RichParameterList& list, vcg::CallBackPos* callback,
        const WriteLog& log);

/// The host's form of a filter's parameters, with their defaults in a document.
void declare_parameters(const Filter& filter, const MeshDocument& document, RichParameterList& list);

/// The host's menus that a filter appears in.
int menus_of(Menu menu);

/// What a filter changes in layers that it does not add.
int post_condition_of(Menu menu);

}  // namespace parts::host
