// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mend/fitting.h"
#include "parts/mend/restore.h"

namespace parts::mend {

/// The published cut of 3.3: compose() with the constraints of Fig. 7, around
/// a flaw (a) or a hole (b).
/// @param keep  of the scan: must survive, a flag a face
/// @param flaw  flaw_flags() of the region
/// @throws UserError  the cut does not close the surface; @throws Cancelled
Restored thesis_cut(const Scan& scan, const Region& region, const Fit& fit, const std::vector<char>& keep,
                    const std::vector<char>& flaw, const RestoreOptions& options, Progress& progress);

}  // namespace parts::mend
