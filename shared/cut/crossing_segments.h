// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/cut/split_faces.h"
#include "parts/spatial/face_tree.h"

namespace parts::cut {

/// A point that both meshes have: an edge of one passes through a face of the
/// other there, or they touch. On each mesh it may lie at a vertex, on an edge
/// or in a face.
struct CrossingPoint {
  std::array<SplitPoint, 2> on;  ///< of A, of B

  const Vec3& position() const { return on[0].position; }
};

/// A line that both meshes have: face_a crosses face_b there, or a side of one
/// lies in the other.
struct CrossingSegment {
  int face_a, face_b;
  std::array<int, 2> ends;  ///< indices of points
};

struct CrossingCurve {
  std::vector<CrossingPoint> points;
  std::vector<CrossingSegment> segments;
  double step = 0;  ///< world units: places nearer than this are one
};

/// Where two meshes cross or touch. What is nearer than `step` is one place,
/// decided once for each vertex and each pair of edges, so that neighbouring
/// faces agree; all else by exact orientation tests on vertices in fixed order.
/// Where faces lie on each other the sides of both are segments: there the two
/// meshes can be split into the same faces.
CrossingCurve find_crossings(const Mesh& a, const spatial::FaceTree& tree_a, const Mesh& b,
                             const spatial::FaceTree& tree_b, double step, int threads);

/// The place of a mesh that is nearer than `step` to a point: a vertex, or else
/// on an edge, or else in a face; nowhere if there is none.
SplitPoint place_on(const Mesh& mesh, const spatial::FaceTree& tree, const Vec3& p, double step);

/// The barycentric coordinates of a face's point that is nearest to p in its plane.
Vec3 barycentric(const Mesh& mesh, int face, const Vec3& p);

/// The curve's points as split points of A (0) or of B (1).
std::vector<SplitPoint> split_points(const CrossingCurve& curve, int side);

}  // namespace parts::cut
