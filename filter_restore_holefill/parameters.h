// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/host/filter.h"

namespace parts {

std::vector<host::Parameter> find_parameters(const host::Scene& scene);
std::vector<host::Parameter> restore_parameters(const host::Scene& scene);
std::vector<host::Parameter> fill_parameters(const host::Scene& scene);
std::vector<host::Parameter> open_parameters(const host::Scene& scene);

}  // namespace parts
