// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/depth/example_set.h"

namespace parts::depth {

/// Above this, a query is too unlike the class.
constexpr double untrusted = 1.5;

/// How far the query's patches are from the examples', as a multiple of how far
/// those of the strangest of a few members of the class are from the others'. On a
/// small scale, before and apart from the reconstruction.
double strangeness(const synthesis::PatchImage& small, const ExampleSet& set, const DepthOptions& options);

}  // namespace parts::depth
