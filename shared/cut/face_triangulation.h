// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::cut {

/// A constrained triangulation of one face, on an integer grid of its
/// barycentric coordinates. All tests are exact in 64-bit integers and none
/// looks at the face's shape, so that needles and faces without area are as
/// good as any. Constraints may cross: they meet in a new vertex.
class FaceTriangulation {
 public:
  static constexpr std::int64_t kUnit = std::int64_t(1) << 30;  ///< the length of the grid's sides
  /// (u, v): the second and third barycentric coordinate, times kUnit.
  using Point = std::array<std::int64_t, 2>;

  /// The face itself; its corners are the vertices 0, 1 and 2.
  FaceTriangulation();

  /// Adds a point on the side from corner k to the next, 0 < at < kUnit. @return its vertex
  int add_on_side(int k, std::int64_t at);
  /// Adds a point, moved to the inside of the face where it is not. @return its
  /// vertex, an older one where they coincide
  int add_inside(const Vec3& barycentric);
  /// Makes the straight line between two vertices a chain of edges.
  void constrain(int u, int v) { constrain(u, v, 0); }
  /// Flips edges that are no constraints until the triangulation is Delaunay in
  /// the plane of a face with these corners.
  void improve(const std::array<Vec3, 3>& corners);

  int vertices() const { return int(points_.size()); }
  Vec3 barycentric(int vertex) const;
  std::vector<Triangle> triangles() const;  ///< counter-clockwise as the face

 private:
  // Half-edge 3 t + k runs from corner k of triangle t to the next.
  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  int from(int h) const { return corner_[h]; }
  int to(int h) const { return corner_[next(h)]; }
  int apex(int h) const { return corner_[previous(h)]; }
  int turn(int a, int b, int c) const;
  int turn(const Point& a, const Point& b, const Point& c) const;
  void link(int h, int g);
  void set(int triangle, int a, int b, int c);
  void fix(int h, bool fixed);
  int add_point(const Point& p);
  int insert(const Point& p);
  int locate(const Point& p);
  void split_triangle(int triangle, int vertex);
  void split_side(int h, int vertex);
  void flip(int h);
  bool convex(int h) const;
  /// The half-edges that start at a vertex.
  template <class Visit>
  void around(int vertex, const Visit& visit) const;
  int edge(int u, int v) const;
  void constrain(int u, int v, int depth);
  /// The edges that the line from u to v passes, up to the first vertex on it. @return that vertex
  int passed(int u, int v, std::vector<std::array<int, 2>>& edges) const;
  Point meeting(int u, int v, int a, int b) const;
  void clear_way(int u, int v, const std::vector<std::array<int, 2>>& edges);

  std::vector<Point> points_;
  std::vector<int> corner_;   ///< per half-edge: the vertex that it starts at
  std::vector<int> mate_;     ///< per half-edge: the opposite one, -1 on the face's sides
  std::vector<char> fixed_;   ///< per half-edge: on a constraint
  std::vector<int> leaving_;  ///< per vertex: a half-edge that starts there
  int last_ = 0;              ///< where the last point was found
};

}  // namespace parts::cut
