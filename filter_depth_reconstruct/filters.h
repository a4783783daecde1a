// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/host/filter.h"

namespace parts {

/// One a source file: name, help, parameters, and what is done with them.
host::Filter build_mappings_filter();
host::Filter depth_to_mesh_filter();
host::Filter reconstruct_depth_filter();

/// Ends the help of each.
extern const char* const depth_reference;

}  // namespace parts
