// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/self_intersections.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "parts/base/parallel.h"
#include "parts/mesh/predicates.h"
#include "parts/mesh/prepare.h"

namespace parts::mesh {
namespace {

using Corners = std::array<Vec3, 3>;

bool on_segment(const Vec3& p, const Vec3& q, const Vec3& x, int axis) {  // x is on their line
  for (int k = 0; k < 3; ++k)
    if (k != axis && (x[k] < std::min(p[k], q[k]) || x[k] > std::max(p[k], q[k]))) return false;
  return true;
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, int axis) {
  const int pqa = turn(p, q, a, axis), pqb = turn(p, q, b, axis);
  const int abp = turn(a, b, p, axis), abq = turn(a, b, q, axis);
  if (pqa * pqb < 0 && abp * abq < 0) return true;
  return (pqa == 0 && on_segment(p, q, a, axis)) || (pqb == 0 && on_segment(p, q, b, axis)) ||
         (abp == 0 && on_segment(a, b, p, axis)) || (abq == 0 && on_segment(a, b, q, axis));
}

/// Both lie in the triangle's plane.
bool meets_in_plane(const Vec3& p, const Vec3& q, const Corners& t) {
  int axis = 0;
  (t[1] - t[0]).cross(t[2] - t[0]).cwiseAbs().maxCoeff(&axis);
  for (int k = 0; k < 3; ++k)
    if (segments_meet(p, q, t[k], t[(k + 1) % 3], axis)) return true;
  const int s0 = turn(t[0], t[1], p, axis), s1 = turn(t[1], t[2], p, axis), s2 = turn(t[2], t[0], p, axis);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

/// Whether the segment and the triangle, with their borders, have a point in
/// common; side_p and side_q are the ends' sides of the triangle's plane.
bool meets(const Vec3& p, int side_p, const Vec3& q, int side_q, const Corners& t) {
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) return meets_in_plane(p, q, t);
  const int s0 = orientation(p, q, t[0], t[1]), s1 = orientation(p, q, t[1], t[2]);
  if (s0 * s1 < 0) return false;
  const int s2 = orientation(p, q, t[2], t[0]);
  return s0 * s2 >= 0 && s1 * s2 >= 0;
}

std::array<int, 3> sides(const Corners& of, const Corners& plane) {
  std::array<int, 3> s;
  for (int k = 0; k < 3; ++k) s[k] = orientation(plane[0], plane[1], plane[2], of[k]);
  return s;
}

bool apart(const std::array<int, 3>& s) {
  return (s[0] > 0 && s[1] > 0 && s[2] > 0) || (s[0] < 0 && s[1] < 0 && s[2] < 0);
}

/// The mesh's finite faces with an area, their corners made one where they coincide.
struct Faces {
  std::vector<int> index;         // in the mesh
  std::vector<Triangle> corners;  // ids of positions
  std::vector<Corners> points;

  explicit Faces(const Mesh& mesh) {
    const std::vector<int> id = first_at_same_place(mesh);
    for (int f = 0; f < mesh.face_count(); ++f) {
      const Corners c{mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)};
      if (!c[0].allFinite() || !c[1].allFinite() || !c[2].allFinite() || collinear(c[0], c[1], c[2])) continue;
      index.push_back(f);
      corners.push_back({id[mesh.faces[f][0]], id[mesh.faces[f][1]], id[mesh.faces[f][2]]});
      points.push_back(c);
    }
  }

  bool intersect(int f, int g) const {
    Corners a = points[f], b = points[g];
    // The common corners to the front of both.
    Triangle ia = corners[f], ib = corners[g];
    int common = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = common; j < 3; ++j)
        if (ia[i] == ib[j]) {
          std::swap(ia[i], ia[common]), std::swap(a[i], a[common]);
          std::swap(ib[j], ib[common]), std::swap(b[j], b[common]);
          ++common;
          break;
        }
    if (common == 3) return true;
    if (common == 2) return folded(a, b);
    const std::array<int, 3> sb = sides(b, a);
    if (common == 0 && apart(sb)) return false;
    const std::array<int, 3> sa = sides(a, b);
    if (common == 1) return meets(a[1], sa[1], a[2], sa[2], b) || meets(b[1], sb[1], b[2], sb[2], a);
    if (apart(sa)) return false;
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      if (meets(a[k], sa[k], a[l], sa[l], b) || meets(b[k], sb[k], b[l], sb[l], a)) return true;
    }
    return false;
  }

  static bool folded(const Corners& a, const Corners& b) {  // on their common side a[0] a[1]
    if (orientation(a[0], a[1], a[2], b[2]) != 0) return false;
    int axis = 0;
    (a[1] - a[0]).cross(a[2] - a[0]).cwiseAbs().maxCoeff(&axis);
    return turn(a[0], a[1], a[2], axis) == turn(a[0], a[1], b[2], axis);
  }
};

/// A binary tree of boxes over the faces in Morton order: node i has the
/// children 2 i and 2 i + 1, its leaves hold kLeaf faces each.
class BoxTree {
 public:
  explicit BoxTree(const Faces& faces) : order_(faces.index.size()), boxes_(faces.index.size()) {
    Box all;
    for (std::size_t f = 0; f < boxes_.size(); ++f) {
      for (const Vec3& p : faces.points[f]) boxes_[f].extend(p);
      all.extend(boxes_[f]);
    }
    std::vector<std::uint64_t> code(boxes_.size());
    for (std::size_t f = 0; f < code.size(); ++f) code[f] = morton(boxes_[f].center(), all);
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(),
              [&](int a, int b) { return code[a] != code[b] ? code[a] < code[b] : a < b; });
    while (leaves_ * kLeaf < int(order_.size())) leaves_ *= 2;
    nodes_.resize(2 * leaves_);
    for (int i = 0; i < int(order_.size()); ++i) nodes_[leaves_ + i / kLeaf].extend(boxes_[order_[i]]);
    for (int n = leaves_ - 1; n > 0; --n) nodes_[n] = nodes_[2 * n].merged(nodes_[2 * n + 1]);
  }

  int face_at(long place) const { return order_[place]; }

  /// Calls visit(face) for the faces behind the one at `place` whose boxes meet its box.
  template <class Visit>
  void later_neighbours(long place, const Visit& visit) const {
    const Box& box = boxes_[order_[place]];
    int stack[64], top = 0;
    stack[top++] = 1;
    while (top) {
      const int n = stack[--top];
      if (!touch(nodes_[n], box) || last_place(n) <= place) continue;
      if (n < leaves_) {
        stack[top++] = 2 * n + 1;
        stack[top++] = 2 * n;
        continue;
      }
      const long begin = std::max(long(n - leaves_) * kLeaf, place + 1);
      const long end = std::min<long>(long(n - leaves_ + 1) * kLeaf, long(order_.size()));
      for (long i = begin; i < end; ++i)
        if (touch(boxes_[order_[i]], box)) visit(order_[i]);
    }
  }

 private:
  static constexpr int kLeaf = 4;
  static bool touch(const Box& a, const Box& b) {
    for (int k = 0; k < 3; ++k)
      if (a.min()[k] > b.max()[k] || b.min()[k] > a.max()[k]) return false;
    return true;
  }
  long last_place(int node) const {
    long n = node;
    while (n < leaves_) n = 2 * n + 1;
    return (n - leaves_ + 1) * kLeaf - 1;
  }
  static std::uint64_t morton(const Vec3& p, const Box& all) {
    std::uint64_t code = 0;
    for (int k = 0; k < 3; ++k) {
      const double size = all.sizes()[k];
      const double share = size > 0 ? (p[k] - all.min()[k]) / size : 0;
      std::uint64_t x = std::uint64_t(std::clamp(share, 0., 1.) * 0x1fffff);
      x = (x | x << 32) & 0x1f00000000ffff;
      x = (x | x << 16) & 0x1f0000ff0000ff;
      x = (x | x << 8) & 0x100f00f00f00f00f;
      x = (x | x << 4) & 0x10c30c30c30c30c3;
      x = (x | x << 2) & 0x1249249249249249;
      code |= x << k;
    }
    return code;
  }
  std::vector<int> order_;
  std::vector<Box> boxes_, nodes_;
  int leaves_ = 1;
};

}  // namespace

std::vector<std::array<int, 2>> intersecting_faces(const Mesh& mesh, long limit, int threads) {
  const Faces faces(mesh);
  const BoxTree tree(faces);
  const long n = long(faces.index.size());
  constexpr long kChunk = 256;  // each stops at the limit by itself, whatever the threads
  std::vector<std::vector<std::array<int, 2>>> found((n + kChunk - 1) / kChunk);
  parallel_for(long(found.size()), threads, [&](long begin, long end) {
    long band = 0;
    for (long c = begin; c < end && (limit <= 0 || band < limit); ++c) {
      const auto enough = [&] { return limit > 0 && band + long(found[c].size()) >= limit; };
      for (long i = c * kChunk; i < std::min(n, (c + 1) * kChunk) && !enough(); ++i) {
        const int f = tree.face_at(i);
        tree.later_neighbours(i, [&](int g) {
          if (!faces.intersect(f, g)) return;
          const auto [low, high] = std::minmax(faces.index[f], faces.index[g]);
          found[c].push_back({low, high});
        });
      }
      band += long(found[c].size());
    }
  });
  std::vector<std::array<int, 2>> pairs;
  for (const auto& chunk : found) pairs.insert(pairs.end(), chunk.begin(), chunk.end());
  if (limit > 0 && long(pairs.size()) > limit) pairs.resize(limit);
  if (limit <= 0) std::sort(pairs.begin(), pairs.end());
  return pairs;
}

long self_intersections(const Mesh& mesh, long limit, int threads) {
  return long(intersecting_faces(mesh, limit, threads).size());
}

}  // namespace parts::mesh
