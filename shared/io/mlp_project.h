// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/base/files.h"
#include "parts/mesh/mesh.h"

namespace parts::io {

/// What a plane of a raster holds, as MeshLab numbers it.
namespace plane {
constexpr int kColor = 1, kMask = 2, kDepth = 8, kBackDepth = 256;  // RGBA, MASK_UB, DEPTH_F, EXTRA00_F
}

/// A mesh layer of a project.
struct MlpMesh {
  std::string label;
  std::string file;  ///< absolute, or relative to the current directory: it opens as it is
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();  ///< file's coordinates to world (MLMatrix44)
};

/// The numbers of a VCGCamera element, as they are in the file. A world point x
/// is at q = rotation (x + translation) in the camera's frame, which looks along -z.
struct MlpCamera {
  bool given = false;                                      ///< the raster has one
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();   ///< minus the eye, world units
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< rows: right, up, towards the viewer
  double focal_mm = 0;
  Eigen::Vector2i viewport_px = Eigen::Vector2i::Zero();  ///< width, height
  Eigen::Vector2d pixel_mm = Eigen::Vector2d::Ones();
  Eigen::Vector2d center_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d distortion = Eigen::Vector2d::Zero();
  int type = 0;  ///< 0 = perspective, 1 = orthographic (vcglib's numbers)
};

struct MlpPlane {
  int semantic = plane::kColor;
  std::string file;  ///< as MlpMesh::file
};

/// An image layer of a project; its planes show the same view.
struct MlpRaster {
  std::string label;
  MlpCamera camera;
  std::vector<MlpPlane> planes;
  /// The file of the first plane of that kind, or "".
  std::string file_of(int semantic) const {
    for (const MlpPlane& p : planes)
      if (p.semantic == semantic) return p.file;
    return "";
  }
};

/// A MeshLab project (.mlp): meshes with their matrices, rasters with all their
/// planes (MeshLab 2020.09 itself reads only the first of each).
struct MlpProject {
  std::vector<MlpMesh> meshes;
  std::vector<MlpRaster> rasters;
};

/// File names come back relative to the project's folder. What the project holds
/// beyond meshes and rasters is ignored; numbers that are missing keep their defaults.
/// @throws UserError  the file is missing, is no project, or has a matrix or
///                    camera that is not made of finite numbers
MlpProject read_mlp(const std::string& path);

/// The same of a project's text; file names stay as they are.
/// @throws formats::Malformed
MlpProject parse_mlp(const std::string& bytes);

/// Files are named relative to the project's folder where that is possible.
/// @throws UserError  the file cannot be written
void write_mlp(const MlpProject& project, const std::string& path);

/// The same as one of several files.
void add_mlp(OutputFiles& files, const MlpProject& project, const std::string& path);

}  // namespace parts::io
