// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/host/filter.h"

namespace parts {

host::Filter colorize_depth_filter();
host::Filter colorize_mesh_filter();

}  // namespace parts
