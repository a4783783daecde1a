// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

#include "parts/search/model_raster.h"
#include "parts/spatial/surface.h"

namespace parts::search {

/// The exhaustive search at the coarsest scale: how well a query fits a model at
/// every whole-voxel shift at once, by convolution. (Thesis 3.3.1 compares
/// occupied voxels; here each side's occupancy meets the other's distance field,
/// max(0, 1 - (d / kReach)^2), so that a surface that is half a voxel off, or not
/// quite the same, still counts.) For 16^3 voxels a convolution takes 40 us, the
/// direct sum over all shifts 30 times as much.
class Correlation {
 public:
  /// A cyclic grid of side^3 voxels (a power of two); models are model_side voxels
  /// long, so that what takes part of the query does not reach around.
  struct Size {
    int side, model_side;
  };
  static constexpr Size kCoarse{16, 9}, kFine{32, 23};
  static constexpr double kWindow = 5.5;  ///< voxels around the region's centre that take part
  static constexpr double kReach = 2.5;   ///< voxels

  using Grid = std::vector<std::complex<float>>;  ///< side^3

  /// A model in the grid's middle, transformed.
  struct Model {
    Size size = kCoarse;
    Grid near, occupied;
    Vec3 center = Vec3::Zero();                       ///< of its box, model's frame
    double cell = 1;                                  ///< a voxel's side, model's frame
    Eigen::Vector3i range = Eigen::Vector3i::Zero();  ///< shifts from -range to range
  };
  static Model model(const ModelRaster& raster, const Size& size);

  /// Two poses of the query (the real and the imaginary part), transformed.
  struct Query {
    Grid near, occupied;
  };
  struct Point {
    Vec3 at;  ///< from the region's centre, query's frame
    double weight;
  };
  /// @param to_voxels_one, to_voxels_two  query's frame to voxels: a rotation and a scale
  static Query query(const std::vector<Point>& points, const Size& size, const Eigen::Matrix3d& to_voxels_one,
                     const Eigen::Matrix3d& to_voxels_two);

  /// The best shift of one pose: voxels from the model's centre to the region's.
  struct Best {
    Eigen::Vector3i shift = Eigen::Vector3i::Zero();
    double similarity = -1;  ///< 0 to 2: the shares of each that lie on the other, added
  };
  static std::array<Best, 2> best(const Query& query, const Model& model);
};

}  // namespace parts::search
