// SPDX-License-Identifier: GPL-3.0-or-later
// The filters of chapter 5 of the thesis: colour by example.
#include "filters.h"

namespace parts {

std::vector<host::Filter> host::filters() { return {colorize_depth_filter(), colorize_mesh_filter()}; }

}  // namespace parts
