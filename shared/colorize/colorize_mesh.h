// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "colorize/color_examples.h"
#include "colorize/view_sheet.h"
#include "geometry/atlas.h"
#include "geometry/progress.h"
#include "mappings/class_models.h"

namespace parts {

struct ColorizeMeshOptions : ColorizeOptions {
  Vec3 up{0, 1, 0}, front{0, 0, 1};         ///< how the mesh stands
  std::vector<View> views;                  ///< from which the surface is seen and coloured
  ExampleOptions rendering;                 ///< size of the views, how the models stand; light is not used
  bool align = true;                        ///< the mesh is moved onto the model most like it, for the comparison
  std::vector<Eigen::Vector3f> correction;  ///< per vertex, added to what was found; empty: none
  std::vector<char> keep;  ///< per face: its own colours stay, and the others go with them; empty: none
};

/// A mesh with colours all over its surface.
struct MeshColors : ColorizeReport {
  std::vector<Vec3> posed;              ///< vertices in the frame of the views
  std::vector<Eigen::Vector3f> vertex;  ///< Y, Cb and Cr of each, 0..1
  std::vector<cv::Mat> planes;          ///< Y, Cb and Cr of the sheet
  cv::Mat example;                      ///< 32S: of the sheet, index into `used`; -1 = background
  ViewSheet sheet;
  bool oriented = true;  ///< the faces look outwards
  double seen = 0;       ///< share of the surface that some view sees; the rest follows the model most like it

  std::vector<Eigen::Vector3f> correction;  ///< per vertex, added to what was found; empty: none
  std::vector<char> keep;                   ///< faces whose colours are their own
  Textures textures;                        ///< of the mesh, for these

  /// Y, Cb and Cr at a point of a face.
  Eigen::Vector3f at(const Mesh& mesh, int face, const Eigen::Vector3f& barycentric) const;
};

/// Finds colours for a whole mesh from coloured models of its class (thesis 6.3):
/// all views are one synthesis, in which pixels that show the same point of the
/// surface have one colour, so that views agree and leave no seams. What no view
/// sees takes the colours of the model most like it at the same place, adapted to
/// the colours around.
/// @throws UserError  a mesh without surface, no model with colours, …
MeshColors colorize_mesh(const Mesh& mesh, ClassModels& models, const ColorizeMeshOptions& options, Progress& progress);

/// The texture of a mesh with these texture coordinates, BGR, and which texels it needs.
struct BakedTexture {
  cv::Mat color;  ///< 8UC3
  cv::Mat mask;   ///< 8U
};
BakedTexture bake_texture(const Mesh& mesh, const std::vector<Wedges>& wedges, int size, const MeshColors& colors,
                          int threads);
std::vector<Color> vertex_colors(const MeshColors& colors);

}  // namespace parts
