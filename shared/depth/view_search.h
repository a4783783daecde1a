// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/base/progress.h"
#include "parts/depth/gallery.h"
#include "parts/depth/options.h"

namespace parts::depth {

/// From where the query is seen. Examples from a few views compete for its
/// patches on a small scale; the mean of the angles, weighted by the patches that
/// they gave, becomes the centre of the next, narrower round (thesis 4.1.3).
/// Where the database stores views, they compete.
/// @param query  small: gallery.small's scale
render::View find_view(const synthesis::PatchImage& query, Gallery& gallery, const DepthOptions& options,
                       Progress& progress);

}  // namespace parts::depth
