// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::cut {

/// A point at which faces of a mesh may be split: on an edge, or in a face. One
/// that a vertex is at already splits nothing.
struct SplitPoint {
  Vec3 position = Vec3::Zero();
  std::array<int, 2> edge{-1, -1};  ///< its vertices, the lower first; -1: on none
  double share = 0;                 ///< of the way from the lower vertex, 0..1
  int face = -1;                    ///< -1: in none
  Vec3 barycentric = Vec3::Zero();
  int vertex = -1;  ///< -1: at none

  static SplitPoint on_edge(const Vec3& position, int low, int high, double share) {
    return {position, {low, high}, share, -1, Vec3::Zero(), -1};
  }
  static SplitPoint in_face(const Vec3& position, int face, const Vec3& barycentric) {
    return {position, {-1, -1}, 0, face, barycentric, -1};
  }
  static SplitPoint at_vertex(const Vec3& position, int vertex) {
    return {position, {-1, -1}, 0, -1, Vec3::Zero(), vertex};
  }

  bool anywhere() const { return vertex >= 0 || edge[0] >= 0 || face >= 0; }
  bool on(int low, int high) const {
    return vertex >= 0 ? vertex == low || vertex == high : edge[0] == low && edge[1] == high;
  }
  /// Whether it lies in a face of the mesh, or on its sides.
  bool within(const Mesh& mesh, int f) const {
    const Triangle& t = mesh.faces[f];
    const auto corner = [&](int v) { return t[0] == v || t[1] == v || t[2] == v; };
    return vertex >= 0 ? corner(vertex) : edge[0] >= 0 ? corner(edge[0]) && corner(edge[1]) : face == f;
  }
};

/// A line in a face along which it is split.
struct SplitSegment {
  int face;
  std::array<int, 2> ends;  ///< indices of points
};

struct SplitMesh {
  Mesh mesh;                   ///< the input's vertices first
  std::vector<int> source;     ///< per face: its index in the input
  std::vector<int> vertex_of;  ///< per point: its vertex, -1 where it is not used
};

/// Splits faces at points and along segments by constrained Delaunay
/// triangulations; faces at none stay as they are, all attributes follow.
/// @param used  per point: whether the mesh is split there (the segments' ends must be)
SplitMesh split_faces(const Mesh& mesh, const std::vector<SplitPoint>& points, const std::vector<char>& used,
                      const std::vector<SplitSegment>& segments);

/// Adds points to the flagged faces, on their edges and in them, where they are
/// larger than `longest` (world units), by bisecting longest edges.
/// @param still  per vertex: edges between two of these stay whole
/// @param near   whether points are wanted within a distance of a place
void add_even_points(const Mesh& mesh, const std::vector<char>& faces, const std::vector<char>& still, double longest,
                     const std::function<bool(const Vec3& place, double distance)>& near,
                     std::vector<SplitPoint>& points);

}  // namespace parts::cut
