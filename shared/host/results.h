// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/host/filter.h"

namespace parts::host {

/// Compares each new layer with its inputs. Logs result_pieces, result_borders,
/// result_nonmanifold, result_pinches, result_flipped and result_crossings of the
/// layer that becomes the current one, and the same as input_... where it has
/// inputs; then "warning: ..." for each layer that is worse than its inputs.
/// @throws UserError         a layer is worse and that is not allowed
/// @throws std::logic_error  a layer that is no mesh: the filter's mistake
void check_results(const Outcome& outcome, bool allow_flaws, Progress& progress);

}  // namespace parts::host
