// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>

#include "parts/spatial/closest_point.h"
#include "parts/spatial/triangle.h"

namespace parts::spatial {
namespace {

double squared_distance(const Vec3& low, const Vec3& high, const Vec3& p) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

TriangleTree::TriangleTree(const Surface& surface) {
  std::vector<int> order(surface.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<Vec3> centers;
  centers.reserve(order.size());
  for (const auto& t : surface.triangles) centers.push_back((t[0] + t[1] + t[2]) / 3);
  nodes_.reserve(order.size());
  nodes_.emplace_back();
  build(0, 0, int(order.size()), surface, centers, order);
  for (int f : order) {
    triangles_.push_back(surface.triangles[f]);
    normals_.push_back(surface.normals[f]);
    number_.push_back(f);
  }
}

void TriangleTree::build(int node, int begin, int end, const Surface& surface, const std::vector<Vec3>& centers,
                         std::vector<int>& order) {
  Box box, center_box;
  for (int i = begin; i < end; ++i) {
    for (const Vec3& v : surface.triangles[order[i]]) box.extend(v);
    center_box.extend(centers[order[i]]);
  }
  nodes_[node].low = box.min();
  nodes_[node].high = box.max();
  if (end - begin <= 4) {
    nodes_[node].first = begin;
    nodes_[node].count = end - begin;
    return;
  }
  int axis = 0;
  center_box.sizes().maxCoeff(&axis);
  const int middle = begin + (end - begin) / 2;
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end, [&](int a, int b) {
    return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
  });
  const int child = int(nodes_.size());
  nodes_.resize(child + 2);
  nodes_[node].first = child;
  build(child, begin, middle, surface, centers, order);
  build(child + 1, middle, end, surface, centers, order);
}

Closest TriangleTree::closest(const Vec3& p, int& hint) const {
  int best = hint;
  Vec3 point = closest_on_triangle(triangles_[best], p);
  double best_squared = (point - p).squaredNorm();
  struct Open {
    int node;
    double squared;
  } stack[64];  // halving: far deeper than any tree gets
  int open = 0;
  stack[open++] = {0, squared_distance(nodes_[0].low, nodes_[0].high, p)};
  while (open > 0) {
    const Open at = stack[--open];
    if (at.squared > best_squared) continue;
    const Node& n = nodes_[at.node];
    if (n.count == 0) {
      Open near{n.first, squared_distance(nodes_[n.first].low, nodes_[n.first].high, p)};
      Open far{n.first + 1, squared_distance(nodes_[n.first + 1].low, nodes_[n.first + 1].high, p)};
      if (far.squared < near.squared) std::swap(near, far);
      stack[open++] = far;
      stack[open++] = near;
      continue;
    }
    for (int i = n.first; i < n.first + n.count; ++i) {
      const Vec3 q = closest_on_triangle(triangles_[i], p);
      const double squared = (q - p).squaredNorm();
      // Of triangles equally close the first one wins, whatever the hint was.
      if (squared < best_squared || (squared == best_squared && i < best)) best_squared = squared, best = i, point = q;
    }
  }
  hint = best;
  return {point, normals_[best], number_[best]};
}

}  // namespace parts::spatial
