// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::render {

/// Which point of a surface each texel of a square texture shows, row by row
/// from the top; uv (0, 0) is the texture's lower left corner.
struct TexelMap {
  int size = 0;                              ///< texels a side
  std::vector<int> face;                     ///< -1 = none
  std::vector<Eigen::Vector3f> barycentric;  ///< in the face
  long conflicts = 0;                        ///< texels that lie inside several faces
};

/// Texels belong to the face their centre lies in, or else to one that is at
/// most a texel away, so that filtering finds colours beyond borders too.
/// @param wedges  as Mesh::wedges; faces without a texture are left out
TexelMap map_texels(const std::vector<Wedges>& wedges, int size);

/// Unfolds a surface into one square texture: faces that look roughly in the
/// same of the six axes' directions are projected along it, chart by chart;
/// what would lie on another part of its chart gets one of its own. All at one
/// scale, packed with gutters of two texels.
struct Atlas {
  std::vector<Wedges> wedges;  ///< per face, of texture 0; of none where a face has no area
  int charts = 0;
  double texels_per_unit = 0;
};
/// @throws UserError  there are more charts than such a texture has room for
Atlas make_atlas(const Mesh& mesh, int size);

/// Why a mesh's own texture coordinates cannot hold a picture of its whole
/// surface. @return empty where they can
std::string texture_coordinates_flaw(const Mesh& mesh, int size);

}  // namespace parts::render
