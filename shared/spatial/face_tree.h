// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::spatial {

/// A tree of boxes over a mesh's faces, in the mesh's own coordinates: which
/// faces of two meshes may touch, what is nearest within a distance, what a ray
/// passes. Safe to ask from several threads.
class FaceTree {
 public:
  struct Hit {
    int face = -1;  ///< -1: nothing within the distance
    Vec3 point = Vec3::Zero();
    double distance = 1e300;
  };

  explicit FaceTree(const Mesh& mesh);

  /// The nearest point of the mesh that is closer than `within`, world units;
  /// of faces equally near the one that the tree comes to first.
  Hit nearest(const Vec3& p, double within) const;

  /// The signed number of faces that the ray from p passes beyond the distance
  /// `from` (in lengths of `direction`): +1 where it leaves the solid, -1 where it enters.
  int winding(const Vec3& p, const Vec3& direction, double from) const;

  /// Calls visit(face of this, face of other) for faces whose boxes come as near as `margin`.
  template <class Visit>
  void for_each_overlap(const FaceTree& other, double margin, const Visit& visit) const;

 private:
  struct Node {
    Vec3 low, high;
    int child = -1;  ///< the first of two; -1 = a leaf
    int begin = 0, end = 0;
  };
  void build(int node, const Mesh& mesh, const std::vector<Vec3>& centers);
  static bool touch(const Node& mine, const Node& theirs, double margin) {
    return (mine.low.array() <= theirs.high.array() + margin).all() &&
           (theirs.low.array() <= mine.high.array() + margin).all();
  }

  Box box(int at) const { return Box(corners_[at][0]).extend(corners_[at][1]).extend(corners_[at][2]); }

  std::vector<Node> nodes_;
  std::vector<int> order_;                    ///< faces in the leaves' order
  std::vector<std::array<Vec3, 3>> corners_;  ///< theirs
};

template <class Visit>
void FaceTree::for_each_overlap(const FaceTree& other, double margin, const Visit& visit) const {
  const Vec3 step = Vec3::Constant(margin);
  if (nodes_.empty() || other.nodes_.empty()) return;
  std::vector<std::array<int, 2>> open{{0, 0}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    const Node &mine = nodes_[i], &theirs = other.nodes_[j];
    if (!touch(mine, theirs, margin)) continue;
    if (mine.child < 0 && theirs.child < 0) {
      for (int p = mine.begin; p < mine.end; ++p)
        for (int q = theirs.begin; q < theirs.end; ++q)
          if (Box(box(p).min() - step, box(p).max() + step).intersects(other.box(q))) visit(order_[p], other.order_[q]);
    } else if (theirs.child < 0 ||
               (mine.child >= 0 && (mine.high - mine.low).squaredNorm() > (theirs.high - theirs.low).squaredNorm())) {
      open.push_back({mine.child, j}), open.push_back({mine.child + 1, j});
    } else {
      open.push_back({i, theirs.child}), open.push_back({i, theirs.child + 1});
    }
  }
}

/// The point of a triangle nearest to p (Ericson, "Real-Time Collision Detection", 5.1.5).
Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace parts::spatial
