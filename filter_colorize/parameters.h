// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/colorize/color_examples.h"
#include "parts/host/filter.h"

namespace parts {

/// What both filters ask about the synthesis: Examples ... Seed.
void add_synthesis(std::vector<host::Parameter>& list);
/// @param preset  what the class says where the user says nothing
void read_synthesis(const host::Inputs& inputs, const io::ClassPreset& preset, const char* slug,
                    colorize::ColorizeOptions& options);

/// What to call the layer of a result, and why one is not to be trusted.
std::string layer_name(const colorize::ColorizeReport& report);
std::string doubt(const colorize::ColorizeReport& report);

void log_report(const colorize::ColorizeReport& report, Progress& progress);

}  // namespace parts
