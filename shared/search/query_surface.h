// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/search/model_raster.h"
#include "parts/search/search.h"
#include "parts/spatial/surface.h"

namespace parts::search {

/// The query as the search sees it: the scan's undamaged surface in a frame of
/// its own (align/surface.h), what lies near the region counting most.
class QuerySurface {
 public:
  /// @throws UserError  no undamaged surface, or none near the region
  explicit QuerySurface(const SearchQuery& query);

  const Vec3& origin() const { return origin_; }
  double size() const { return size_; }          ///< world units in a frame's unit
  const Box& region() const { return region_; }  ///< in the frame
  double radius() const { return radius_; }      ///< half diagonal of the region, in the frame

  /// How much a place counts: 1 in the region, less and less with the distance
  /// from it, a quarter at `reach` (in radii of the region).
  double weight(const Vec3& p, double reach) const {
    const double d = region_.squaredExteriorDistance(p) / (reach * reach * radius_ * radius_);
    return 1 / ((1 + d) * (1 + d));
  }

  /// Samples as dense as places count; every prefix is so too.
  std::vector<spatial::Sample> samples(double reach, int count) const;
  /// The integral of the weight over the undamaged surface.
  double weighted_area(double reach) const;

  double spacing() const { return spacing_; }  ///< about, of the points that nearest() finds

  /// What is known of the surface near a point: where it is, or nothing next to
  /// a border or to damage, where the scan does not say how it goes on (and
  /// beyond three radii from the region, where nobody asks).
  enum class Known { Surface, Nothing, Far };
  Known nearest(const Vec3& p, RasterPoint& found) const;

 private:
  spatial::Surface weighted(double reach) const;
  void make_grid(const SearchQuery& query);

  Vec3 origin_ = Vec3::Zero();
  double size_ = 1, radius_ = 1, spacing_ = 0;
  Box region_;
  spatial::Surface surface_;         ///< undamaged triangles
  std::vector<double> face_weight_;  ///< of these triangles
  std::vector<RasterPoint> points_;  ///< known ones, then unknown ones
  std::size_t known_ = 0;
  RasterLevel grid_;
};

}  // namespace parts::search
