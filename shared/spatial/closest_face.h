// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "parts/mesh/mesh.h"
#include "parts/spatial/closest_point.h"

namespace parts::spatial {

/// Where a mesh is closest to a point.
struct FaceHit {
  int face = -1;
  Vec3 point = Vec3::Zero(), normal = Vec3::Zero();  ///< unit normal of the face
  Vec3 barycentric = Vec3::Zero();                   ///< of the point in the face
  double distance = 1e300;
  bool on_border = false;  ///< the point lies on an edge that has one face: beyond it there is no surface
};

/// Answers where a mesh, or a part of it, is closest. Safe to ask from several threads.
class ClosestFace {
 public:
  /// @param mesh   kept by reference
  /// @param flags  1 = belongs to the part; empty = every face. Faces without
  ///               area never answer. A border is one of the part.
  explicit ClosestFace(const Mesh& mesh, const std::vector<char>& flags = {});

  bool empty() const { return !tree_; }
  /// @pre not empty
  /// @param hint  what the last call near this point left; 0 at first
  FaceHit operator()(const Vec3& p, int& hint) const;
  FaceHit operator()(const Vec3& p) const {
    int hint = 0;
    return (*this)(p, hint);
  }

 private:
  const Mesh& mesh_;
  std::unique_ptr<TriangleTree> tree_;
  std::vector<int> face_;                         ///< per triangle of the tree
  std::vector<std::array<bool, 3>> border_edge_;  ///< per face of the mesh
  std::vector<char> border_vertex_;
};

}  // namespace parts::spatial
