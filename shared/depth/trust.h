// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/depth/evidence.h"
#include "parts/depth/example_set.h"

namespace parts::depth {

/// @param small  the query: at the scale of Gallery::small
Evidence gather_evidence(const synthesis::PatchImage& small, const ExampleSet& set, const DepthOptions& options);

/// Whether a reconstruction is to be trusted: bounds calibrated by bench_trust.
bool is_trusted(const Evidence& evidence);

}  // namespace parts::depth
