// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/cut/split_faces.h"
#include "parts/spatial/face_tree.h"

namespace parts::cut {

/// A point in which an edge of one mesh passes through a face of the other: a
/// split point of both.
struct CrossingPoint {
  Vec3 position;
  bool edge_of_a;
  std::array<int, 2> edge;  ///< its vertices, the lower first
  double share;             ///< of the way from the lower vertex
  int face;                 ///< of the other mesh
};

/// A piece of the curve in which the meshes cross: face_a crosses face_b there.
struct CrossingSegment {
  int face_a, face_b;
  std::array<int, 2> ends;  ///< indices of points
};

struct CrossingCurve {
  std::vector<CrossingPoint> points;
  std::vector<CrossingSegment> segments;
};

/// Where two meshes cross. Each point is decided by exact orientation tests, the
/// edge's and the face's vertices in fixed order, so that neighbouring faces
/// agree; a zero counts as positive, so that meshes that only touch cross in a
/// consistent way or not at all.
CrossingCurve find_crossings(const Mesh& a, const spatial::FaceTree& tree_a, const Mesh& b,
                             const spatial::FaceTree& tree_b);

/// The curve's points as split points of A or of B.
std::vector<SplitPoint> split_points(const CrossingCurve& curve, const Mesh& mesh, bool of_a);

}  // namespace parts::cut
