// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "parts/mesh/loops.h"
#include "parts/seam/clip.h"
#include "parts/spatial/closest_point.h"

namespace parts::mend {

/// The distance to borders of a scan. @pre one of them has an edge
class RimDistance {
 public:
  RimDistance(const Mesh& scan, const std::vector<mesh::Loop>& rims);
  double operator()(const Vec3& p) const;

 private:
  std::unique_ptr<spatial::TriangleTree> tree_;
};

/// How a model is cut to a hole, world units.
struct PatchOptions {
  double edge = 0;       ///< the mean edge of the rim
  double tolerance = 0;  ///< how far a model's surface may lie from the scan's and still be the same
  double gap = 0;        ///< how far from the rims the patch ends
  double max_gap = 0;    ///< how far its border may lie from the rim, on average
  int threads = 0;
};

/// The part of a model that lies beyond a scan's borders and faces one of them.
/// Splinters between the rim's teeth are left to the stitch.
/// @param rims  all borders of the scan
/// @param rim   the one that is to be closed
seam::Clipped patch_beyond(const Mesh& scan, const Mesh& model, const std::vector<mesh::Loop>& rims,
                           const mesh::Loop& rim, const PatchOptions& options);

}  // namespace parts::mend
