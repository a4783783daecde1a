// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/spatial/face_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace parts::spatial {
namespace {

constexpr int kLeaf = 4;    // faces
constexpr int kDepth = 96;  // nodes that wait, of a tree that halves its faces

double squared_distance(const Vec3& low, const Vec3& high, const Vec3& p) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

FaceTree::FaceTree(const Mesh& mesh) : order_(mesh.faces.size()) {
  if (mesh.faces.empty()) return;
  std::iota(order_.begin(), order_.end(), 0);
  std::vector<Vec3> centers(mesh.faces.size());
  for (int f = 0; f < mesh.face_count(); ++f) centers[f] = mesh.center(f);
  nodes_.reserve(mesh.faces.size());
  nodes_.emplace_back();
  nodes_[0].end = mesh.face_count();
  build(0, mesh, centers);
  corners_.reserve(order_.size());
  for (int f : order_) corners_.push_back({mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)});
}

void FaceTree::build(int node, const Mesh& mesh, const std::vector<Vec3>& centers) {
  const int begin = nodes_[node].begin, end = nodes_[node].end;
  Box box, middles;
  for (int i = begin; i < end; ++i) {
    for (int v : mesh.faces[order_[i]]) box.extend(mesh.vertices[v]);
    middles.extend(centers[order_[i]]);
  }
  nodes_[node].low = box.min(), nodes_[node].high = box.max();
  if (end - begin <= kLeaf) return;
  int axis;
  middles.sizes().maxCoeff(&axis);
  const int half = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, [&](int a, int b) {
    return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
  });
  const int child = int(nodes_.size());
  nodes_[node].child = child;
  nodes_.resize(child + 2);
  nodes_[child].begin = begin, nodes_[child].end = half;
  nodes_[child + 1].begin = half, nodes_[child + 1].end = end;
  build(child, mesh, centers);
  build(child + 1, mesh, centers);
}

FaceTree::Hit FaceTree::nearest(const Vec3& p, double within) const {
  Hit hit;
  if (nodes_.empty()) return hit;
  double least = within * within;
  std::array<int, kDepth> open;
  int waiting = 0;
  open[waiting++] = 0;
  while (waiting) {
    const Node& n = nodes_[open[--waiting]];
    if (squared_distance(n.low, n.high, p) >= least) continue;
    if (n.child < 0) {
      for (int i = n.begin; i < n.end; ++i) {
        const Vec3 q = nearest_on_triangle(p, corners_[i][0], corners_[i][1], corners_[i][2]);
        if (const double d = (q - p).squaredNorm(); d < least) least = d, hit.face = order_[i], hit.point = q;
      }
      continue;
    }
    const double first = squared_distance(nodes_[n.child].low, nodes_[n.child].high, p),
                 second = squared_distance(nodes_[n.child + 1].low, nodes_[n.child + 1].high, p);
    open[waiting++] = first < second ? n.child + 1 : n.child;  // the nearer one next
    open[waiting++] = first < second ? n.child : n.child + 1;
  }
  if (hit.face >= 0) hit.distance = std::sqrt(least);
  return hit;
}

int FaceTree::winding(const Vec3& p, const Vec3& direction, double from) const {
  if (nodes_.empty()) return 0;
  const Vec3 inverse = direction.cwiseInverse();
  int count = 0;
  std::vector<int> open{0};
  while (!open.empty()) {
    const Node& n = nodes_[open.back()];
    open.pop_back();
    double enter = from, leave = 1e300;
    for (int k = 0; k < 3; ++k) {
      const double u = (n.low[k] - p[k]) * inverse[k], v = (n.high[k] - p[k]) * inverse[k];
      enter = std::max(enter, std::min(u, v)), leave = std::min(leave, std::max(u, v));
    }
    if (enter > leave * (1 + 1e-12)) continue;
    if (n.child >= 0) {
      open.push_back(n.child), open.push_back(n.child + 1);
      continue;
    }
    for (int i = n.begin; i < n.end; ++i) {  // Möller and Trumbore's test
      const Vec3 &a = corners_[i][0], e = corners_[i][1] - a, g = corners_[i][2] - a, q = direction.cross(g), s = p - a,
                 r = s.cross(e);
      const double det = e.dot(q);
      if (det == 0) continue;
      const double u = s.dot(q) / det, v = direction.dot(r) / det;
      if (u < 0 || v < 0 || u + v > 1 || g.dot(r) / det <= from) continue;
      count += det > 0 ? -1 : 1;
    }
  }
  return count;
}

Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return sum > 0 ? Vec3(a + ab * (vb / sum) + ac * (vc / sum)) : a;
}

}  // namespace parts::spatial
