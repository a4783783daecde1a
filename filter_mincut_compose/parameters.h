// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/host/filter.h"

namespace parts {

std::vector<host::Parameter> align_parameters(const host::Scene& scene);
std::vector<host::Parameter> compose_parameters(const host::Scene& scene);
std::vector<host::Parameter> deform_parameters(const host::Scene& scene);

}  // namespace parts
