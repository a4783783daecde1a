// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/depth/gallery.h"
#include "parts/depth/options.h"

namespace parts::depth {

/// In what light the query was taken: of a few lights the one in which the
/// objects, seen from the view, look most like the query, where that is clearly
/// more than in the light they are rendered in. (Thesis 4.1.3: lighting can be
/// resolved like the view.)
/// @param query  small: gallery.small's scale
/// @return gallery.light() where no other is clearly better; nothing to search
///         where examples are stored
examples::Light find_light(const synthesis::PatchImage& query, Gallery& gallery, const render::View& view,
                           const DepthOptions& options);

}  // namespace parts::depth
