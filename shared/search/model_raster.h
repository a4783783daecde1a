// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "parts/mesh/mesh.h"
#include "parts/spatial/closest_point.h"

namespace parts::search {

/// A point of a surface and the unit normal of its face.
struct RasterPoint {
  Eigen::Vector3f at, normal;
};

/// A grid over a model whose voxels know the sample of the surface that is
/// nearest to their centre: an occupancy grid and a distance field in one.
struct RasterLevel {
  static constexpr std::uint16_t kFar = 0xffff;  ///< farther than kReach voxels from the surface
  static constexpr double kReach = 4;

  Eigen::Vector3f low = Eigen::Vector3f::Zero();  ///< corner of the first voxel, model's frame
  float cell = 1;                                 ///< side of a voxel
  std::array<int, 3> dims{0, 0, 0};
  std::vector<std::uint16_t> nearest;  ///< index of a sample, x fastest

  /// The sample known to the voxel that p lies in (the closest one to p inside the grid), or kFar.
  std::uint16_t at(const Vec3& p) const {
    std::array<int, 3> c;
    for (int d = 0; d < 3; ++d) c[d] = int(std::clamp((p[d] - double(low[d])) / double(cell), 0.0, dims[d] - 1.0));
    return nearest[c[0] + std::size_t(dims[0]) * (c[1] + std::size_t(dims[1]) * c[2])];
  }
};

/// @param reach  voxels; how far from a sample it is known
/// @pre fewer than kFar samples
RasterLevel nearest_samples(const std::vector<RasterPoint>& samples, const Eigen::AlignedBox3f& box, int resolution,
                            double reach = RasterLevel::kReach);

/// A model as the search sees it, in a frame of its own (align/surface.h):
/// centroid at the origin, RMS radius 1, whatever its units.
struct ModelRaster {
  static constexpr int kSamples = 4096;
  static constexpr int kCoarsest = 16;  ///< voxels along the longest side at level 0; twice as many at each next

  Vec3 origin = Vec3::Zero();        ///< world
  double size = 1;                   ///< world units in a frame's unit
  double area = 0;                   ///< of the surface, in the frame
  std::vector<RasterPoint> samples;  ///< uniform over the area; so is every prefix
  std::vector<RasterLevel> levels;

  Eigen::AlignedBox3f box() const {
    Eigen::AlignedBox3f b;
    for (const RasterPoint& p : samples) b.extend(p.at);
    return b;
  }
};

/// @pre the model has faces with area and finite coordinates (ModelDatabase::load)
/// @throws UserError  no area
ModelRaster rasterize_model(const Mesh& model, int levels);
/// Adds the next finer level.
void add_level(ModelRaster& raster);

/// A level as a surface that answers where it is closest, in about 20 ns.
class RasterTarget : public spatial::ClosestPoint {
 public:
  RasterTarget(const ModelRaster& raster, int level) : raster_(raster), level_(level) {}
  spatial::Closest closest(const Vec3& p, int& hint) const override;

 private:
  const ModelRaster& raster_;
  int level_;
};

}  // namespace parts::search
