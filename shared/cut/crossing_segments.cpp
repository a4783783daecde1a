// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/crossing_segments.h"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "parts/base/parallel.h"
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

/// Where between its ends the line p, q comes nearest to the line r, s, and the
/// other way round; false where they are parallel.
bool nearest_shares(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, double& on_pq, double& on_rs) {
  const Vec3 u = q - p, v = s - r, w = p - r;
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm(), whole = uu * vv - uv * uv;
  if (!(whole > 1e-20 * uu * vv)) return false;
  on_pq = (uv * v.dot(w) - vv * u.dot(w)) / whole, on_rs = (uu * v.dot(w) - uv * u.dot(w)) / whole;
  return true;
}

struct SideOf {
  int low, high;
};
SideOf side_of(const Triangle& t, int k) { return {std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}; }

class Finder {
 public:
  Finder(const Mesh& a, const spatial::FaceTree& tree_a, const Mesh& b, const spatial::FaceTree& tree_b, double step,
         int threads)
      : mesh_{&a, &b} {
    curve.step = step;
    find_touching_vertices({&tree_a, &tree_b}, threads);
  }
  CrossingCurve curve;

  void cross(int face_a, int face_b);

 private:
  struct Key {
    std::array<int, 4> of;
    bool operator==(const Key& o) const { return of == o.of; }
  };
  struct Hash {
    std::size_t operator()(const Key& k) const {
      std::uint64_t h = 0;
      for (int i : k.of) h = (h ^ std::uint32_t(i)) * 0x9E3779B97F4A7C15ull, h ^= h >> 29;
      return h;
    }
  };

  void find_touching_vertices(const std::array<const spatial::FaceTree*, 2>& tree, int threads);
  int add(const SplitPoint& on_a, const SplitPoint& on_b) {
    curve.points.push_back({{on_a, on_b}});
    return int(curve.points.size()) - 1;
  }
  int meeting(const SideOf& of_a, const SideOf& of_b);
  int passing(int x, const SideOf& side, int face);
  void add_sides(int face_a, int face_b, const std::vector<int>& found);
  const Vec3& at(int x, int v) const { return mesh_[x]->vertices[v]; }

  const Mesh* mesh_[2];
  std::vector<SplitPoint> image_[2];  ///< per vertex of A, of B: where on the other it lies
  std::vector<int> point_[2];         ///< and its point, -1
  std::unordered_map<Key, int, Hash> meetings_, passings_[2];
};

void Finder::find_touching_vertices(const std::array<const spatial::FaceTree*, 2>& tree, int threads) {
  for (int x : {0, 1}) {
    const Mesh &mine = *mesh_[x], &other = *mesh_[1 - x];
    image_[x].resize(mine.vertices.size()), point_[x].assign(mine.vertices.size(), -1);
    parallel_for(mine.vertex_count(), threads, [&](long begin, long end) {
      for (long v = begin; v < end; ++v) image_[x][v] = place_on(other, *tree[1 - x], mine.vertices[v], curve.step);
    });
  }
  // Where a vertex of one lies at one of the other, it is so the other way round too.
  for (int x : {0, 1})
    for (int v = 0; v < mesh_[x]->vertex_count(); ++v)
      if (const int u = image_[x][v].vertex; u >= 0 && image_[1 - x][u].vertex < 0)
        image_[1 - x][u] = SplitPoint::at_vertex(at(x, v), v);
  for (int x : {0, 1})
    for (int v = 0; v < mesh_[x]->vertex_count(); ++v) {
      const SplitPoint& image = image_[x][v];
      if (!image.anywhere()) continue;
      if (x == 1 && image.vertex >= 0 && image_[0][image.vertex].vertex == v) {
        point_[1][v] = point_[0][image.vertex];
        continue;
      }
      const SplitPoint own = SplitPoint::at_vertex(at(x, v), v);
      point_[x][v] = x == 0 ? add(own, image) : add(image, own);
    }
}

/// The point in which two edges meet within themselves, -1 if they do not.
int Finder::meeting(const SideOf& of_a, const SideOf& of_b) {
  for (int v : {of_a.low, of_a.high})
    if (image_[0][v].on(of_b.low, of_b.high)) return -1;
  for (int v : {of_b.low, of_b.high})
    if (image_[1][v].on(of_a.low, of_a.high)) return -1;
  const Vec3 &p = at(0, of_a.low), &q = at(0, of_a.high), &r = at(1, of_b.low), &s = at(1, of_b.high);
  const Vec3 step = Vec3::Constant(curve.step);
  if (!Box(p.cwiseMin(q) - step, p.cwiseMax(q) + step).intersects(Box(r.cwiseMin(s), r.cwiseMax(s)))) return -1;
  const auto [it, fresh] = meetings_.try_emplace(Key{{of_a.low, of_a.high, of_b.low, of_b.high}}, -1);
  double on_a, on_b;
  if (fresh && nearest_shares(p, q, r, s, on_a, on_b) && on_a > 0 && on_a < 1 && on_b > 0 && on_b < 1) {
    const Vec3 x = p + on_a * (q - p), y = r + on_b * (s - r);
    if ((x - y).norm() <= curve.step)
      it->second =
          add(SplitPoint::on_edge(x, of_a.low, of_a.high, on_a), SplitPoint::on_edge(x, of_b.low, of_b.high, on_b));
  }
  return it->second;
}

/// The point in which an edge of one mesh passes through a face of the other
/// that it does not touch, -1 if it does not.
int Finder::passing(int x, const SideOf& side, int face) {
  const Mesh& other = *mesh_[1 - x];
  const Vec3 &p = at(x, side.low), &q = at(x, side.high);
  if (!Box(p.cwiseMin(q), p.cwiseMax(q)).intersects(other.face_box(face))) return -1;
  for (int v : {side.low, side.high})
    if (image_[x][v].within(other, face)) return -1;
  for (int v : other.faces[face])
    if (image_[1 - x][v].on(side.low, side.high)) return -1;
  for (int k = 0; k < 3; ++k) {
    const SideOf theirs = side_of(other.faces[face], k);
    if ((x == 0 ? meeting(side, theirs) : meeting(theirs, side)) >= 0) return -1;
  }
  const auto [it, fresh] = passings_[x].try_emplace(Key{{side.low, side.high, face, 0}}, -1);
  double share;
  if (fresh && pierces(p, q, other, face, share)) {
    const Vec3 position = p + share * (q - p);
    const SplitPoint mine = SplitPoint::on_edge(position, side.low, side.high, share),
                     theirs = SplitPoint::in_face(position, face, barycentric(other, face, position));
    it->second = x == 0 ? add(mine, theirs) : add(theirs, mine);
  }
  return it->second;
}

void Finder::cross(int face_a, int face_b) {
  const Triangle &a = mesh_[0]->faces[face_a], &b = mesh_[1]->faces[face_b];
  std::vector<int> found;
  const auto note = [&](int p) {
    if (p >= 0 && std::find(found.begin(), found.end(), p) == found.end()) found.push_back(p);
  };
  for (int v : a)
    if (image_[0][v].within(*mesh_[1], face_b)) note(point_[0][v]);
  for (int v : b)
    if (image_[1][v].within(*mesh_[0], face_a)) note(point_[1][v]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) note(meeting(side_of(a, i), side_of(b, j)));
  for (int k = 0; k < 3; ++k) note(passing(0, side_of(a, k), face_b));
  for (int k = 0; k < 3; ++k) note(passing(1, side_of(b, k), face_a));
  if (found.size() < 2) return;
  if (found.size() == 2)
    curve.segments.push_back({face_a, face_b, {found[0], found[1]}});
  else
    add_sides(face_a, face_b, found);
}

/// The faces lie on each other: what of the sides of one lies in the other.
void Finder::add_sides(int face_a, int face_b, const std::vector<int>& found) {
  const int face[2] = {face_a, face_b};
  for (int x : {0, 1})
    for (int k = 0; k < 3; ++k) {
      const SideOf side = side_of(mesh_[x]->faces[face[x]], k);
      std::vector<std::pair<double, int>> along;
      for (int p : found)
        if (const SplitPoint& on = curve.points[p].on[x]; on.on(side.low, side.high))
          along.emplace_back(on.vertex >= 0 ? double(on.vertex == side.high) : on.share, p);
      std::sort(along.begin(), along.end());
      for (std::size_t i = 1; i < along.size(); ++i)
        curve.segments.push_back({face_a, face_b, {along[i - 1].second, along[i].second}});
    }
}

}  // namespace

Vec3 barycentric(const Mesh& mesh, int face, const Vec3& p) {
  const Vec3 n = mesh.area_vector(face), &a = mesh.corner(face, 0), &b = mesh.corner(face, 1),
             &c = mesh.corner(face, 2);
  const double whole = std::max(n.squaredNorm(), 1e-300);
  const Vec3 l(0, (p - a).cross(c - a).dot(n) / whole, (b - a).cross(p - a).dot(n) / whole);
  return {1 - l[1] - l[2], l[1], l[2]};
}

SplitPoint place_on(const Mesh& mesh, const spatial::FaceTree& tree, const Vec3& p, double step) {
  const spatial::FaceTree::Hit hit = tree.nearest(p, step);
  if (hit.face < 0) return {};
  const Triangle& t = mesh.faces[hit.face];
  int vertex = -1;
  double least = step;
  for (int v : t)
    if (const double d = (mesh.vertices[v] - p).norm(); d <= least) least = d, vertex = v;
  if (vertex >= 0) return SplitPoint::at_vertex(p, vertex);
  SplitPoint place;
  least = step;
  for (int k = 0; k < 3; ++k) {
    const auto [low, high] = side_of(t, k);
    const Vec3 &from = mesh.vertices[low], along = mesh.vertices[high] - from;
    const double share = std::clamp((p - from).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
    if (const double d = (from + share * along - p).norm(); d <= least)
      least = d, place = SplitPoint::on_edge(p, low, high, share);
  }
  return place.anywhere() ? place : SplitPoint::in_face(p, hit.face, barycentric(mesh, hit.face, p));
}

CrossingCurve find_crossings(const Mesh& a, const spatial::FaceTree& tree_a, const Mesh& b,
                             const spatial::FaceTree& tree_b, double step, int threads) {
  Finder finder(a, tree_a, b, tree_b, step, threads);
  tree_a.for_each_overlap(tree_b, step, [&](int f, int g) {
    if (a.area_vector(f) != Vec3::Zero() && b.area_vector(g) != Vec3::Zero()) finder.cross(f, g);
  });
  return std::move(finder.curve);
}

std::vector<SplitPoint> split_points(const CrossingCurve& curve, int side) {
  std::vector<SplitPoint> points;
  for (const CrossingPoint& p : curve.points) points.push_back(p.on[side]);
  return points;
}

}  // namespace parts::cut
