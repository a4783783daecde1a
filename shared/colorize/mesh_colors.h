// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "parts/colorize/find_frame.h"
#include "parts/colorize/report.h"
#include "parts/colorize/view_sheet.h"
#include "parts/examples/class_models.h"
#include "parts/render/load_textures.h"

namespace parts::colorize {

/// A mesh with colours all over its surface.
struct MeshColors : ColorizeReport {
  std::vector<Vec3> posed;              ///< vertices in the frame of the views
  std::vector<Eigen::Vector3f> vertex;  ///< Y, Cb and Cr of each, 0..1
  std::vector<cv::Mat> planes;          ///< Y, Cb and Cr of the sheet
  cv::Mat example;                      ///< 32S: of the sheet, index into `used`; -1 = background
  ViewSheet sheet;
  std::optional<Standing> turned;  ///< it stands otherwise than it was said to
  bool oriented = true;            ///< the faces look outwards
  bool continued = true;  ///< the colours of hidden parts go over into those that are seen (see complete_colors)
  double seen = 0;        ///< share of the surface that some view sees; the rest follows the model most like it

  std::vector<Eigen::Vector3f> correction;  ///< per vertex, added to what was found; empty: none
  std::vector<char> keep;                   ///< faces whose colours are their own
  render::Textures textures;                ///< of the mesh, for these

  /// Y, Cb and Cr at a point of a face.
  Eigen::Vector3f at(const Mesh& mesh, int face, const Eigen::Vector3f& barycentric) const;
};

/// Colours every vertex of a mesh whose views have been coloured, and then, where
/// colours are kept, makes the others go with them. Fills posed, vertex, seen,
/// correction and textures.
/// @param query  the mesh in the frame of the views
/// @param like   the model whose colours hidden parts take
void color_surface(const examples::ClassModel& query, const examples::ClassModel& like, int threads,
                   MeshColors& colors);

/// The texture of a mesh with these texture coordinates, BGR, and which texels it needs.
struct BakedTexture {
  cv::Mat color;  ///< 8UC3
  cv::Mat mask;   ///< 8U
};
BakedTexture bake_texture(const Mesh& mesh, const std::vector<Wedges>& wedges, int size, const MeshColors& colors,
                          int threads);
std::vector<Color> vertex_colors(const MeshColors& colors);

}  // namespace parts::colorize
