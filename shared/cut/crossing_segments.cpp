// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/crossing_segments.h"

#include <algorithm>
#include <unordered_map>

#include "parts/mesh/predicates.h"

namespace parts::cut {
namespace {

int sign(int orientation) { return orientation == 0 ? 1 : orientation; }

/// Whether the segment p, q passes through a face of a mesh. @param share  of the way from p
bool pierces(const Vec3& p, const Vec3& q, const Mesh& mesh, int face, double& share) {
  const Triangle& t = mesh.faces[face];
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  if (sign(mesh::orientation(a, b, c, p)) == sign(mesh::orientation(a, b, c, q))) return false;
  // The same answer for both faces at an edge, whichever way they run along it.
  const auto side = [&](int i, int j) {
    const int s = sign(mesh::orientation(p, q, mesh.vertices[std::min(i, j)], mesh.vertices[std::max(i, j)]));
    return i < j ? s : -s;
  };
  const int first = side(t[0], t[1]);
  if (side(t[1], t[2]) != first || side(t[2], t[0]) != first) return false;
  const Vec3 normal = mesh.area_vector(face);
  const double above_p = (p - a).dot(normal), above_q = (q - a).dot(normal);
  share = above_p != above_q ? std::clamp(above_p / (above_p - above_q), 0.0, 1.0) : 0.5;
  return true;
}

class Finder {
 public:
  Finder(const Mesh& a, const Mesh& b) : a_(a), b_(b) {}
  CrossingCurve curve;

  void cross(int face_a, int face_b) {
    std::array<int, 6> found;
    int count = 0;
    for (int k = 0; k < 3; ++k)
      if (const int p = point(true, face_a, k, face_b); p >= 0) found[count++] = p;
    for (int k = 0; k < 3; ++k)
      if (const int p = point(false, face_b, k, face_a); p >= 0) found[count++] = p;
    if (count < 2) return;
    // Two, but where the faces touch in a way that the zeros decide: then the farthest.
    std::array<int, 2> ends{found[0], found[1]};
    double farthest = -1;
    for (int i = 0; i < count; ++i)
      for (int j = i + 1; j < count; ++j)
        if (const double d = (curve.points[found[i]].position - curve.points[found[j]].position).squaredNorm();
            d > farthest)
          farthest = d, ends = {found[i], found[j]};
    curve.segments.push_back({face_a, face_b, ends});
  }

 private:
  struct Key {
    int low, high, face;
    bool operator==(const Key& o) const { return low == o.low && high == o.high && face == o.face; }
  };
  struct Hash {
    std::size_t operator()(const Key& k) const {
      return ((k.low * 0x9E3779B97F4A7C15ull + k.high) * 0xC2B2AE3D27D4EB4Full + k.face) * 0x9E3779B97F4A7C15ull;
    }
  };

  /// The point in which edge k of a face passes through a face of the other mesh, -1 if in none.
  int point(bool edge_of_a, int face, int k, int through) {
    const Mesh &mine = edge_of_a ? a_ : b_, &other = edge_of_a ? b_ : a_;
    const int i = mine.faces[face][k], j = mine.faces[face][(k + 1) % 3], low = std::min(i, j), high = std::max(i, j);
    const Vec3 &p = mine.vertices[low], &q = mine.vertices[high];
    if (!Box(p.cwiseMin(q), p.cwiseMax(q)).intersects(other.face_box(through))) return -1;
    const auto [it, fresh] = seen_[edge_of_a].try_emplace({low, high, through}, -1);
    double share;
    if (fresh && pierces(p, q, other, through, share)) {
      it->second = int(curve.points.size());
      curve.points.push_back({p + share * (q - p), edge_of_a, {low, high}, share, through});
    }
    return it->second;
  }

  const Mesh &a_, &b_;
  std::unordered_map<Key, int, Hash> seen_[2];
};

Vec3 barycentric(const Mesh& mesh, int face, const Vec3& p) {
  const Vec3 n = mesh.area_vector(face), &a = mesh.corner(face, 0), &b = mesh.corner(face, 1),
             &c = mesh.corner(face, 2);
  const double whole = std::max(n.squaredNorm(), 1e-300);
  const Vec3 l(0, (p - a).cross(c - a).dot(n) / whole, (b - a).cross(p - a).dot(n) / whole);
  return {1 - l[1] - l[2], l[1], l[2]};
}

}  // namespace

CrossingCurve find_crossings(const Mesh& a, const spatial::FaceTree& tree_a, const Mesh& b,
                             const spatial::FaceTree& tree_b) {
  Finder finder(a, b);
  tree_a.for_each_overlap(tree_b, [&](int f, int g) {
    if (a.area_vector(f) != Vec3::Zero() && b.area_vector(g) != Vec3::Zero()) finder.cross(f, g);
  });
  return std::move(finder.curve);
}

std::vector<SplitPoint> split_points(const CrossingCurve& curve, const Mesh& mesh, bool of_a) {
  std::vector<SplitPoint> points;
  for (const CrossingPoint& p : curve.points)
    points.push_back(p.edge_of_a == of_a
                         ? SplitPoint::on_edge(p.position, p.edge[0], p.edge[1], p.share)
                         : SplitPoint::in_face(p.position, p.face, barycentric(mesh, p.face, p.position)));
  return points;
}

}  // namespace parts::cut
