// SPDX-License-Identifier: GPL-3.0-or-later
// The filters of chapter 4 of the thesis: depth from a single image by example.
#include "filters.h"

namespace parts {

const char* const depth_reference =
    "<br><br>See:<br><i>T. Hassner, R. Basri</i><br><b>\"Example based 3D reconstruction from single 2D "
    "images\"</b><br>Beyond Patches Workshop at CVPR 2006";

std::vector<host::Filter> host::filters() {
  return {
      build_mappings_filter(),
      depth_to_mesh_filter(),
      reconstruct_depth_filter(),
  };
}

}  // namespace parts
