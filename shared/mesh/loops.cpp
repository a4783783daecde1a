// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/loops.h"

#include <unordered_map>

#include "parts/mesh/edges.h"

namespace parts::mesh {

std::vector<Loop> trace_loops(const std::vector<std::array<int, 2>>& half_edges) {
  std::unordered_map<int, std::vector<int>> leaving;  // vertex -> half-edges, last first
  std::unordered_map<int, int> excess;                // leaving minus entering
  for (int e = int(half_edges.size()) - 1; e >= 0; --e) {
    leaving[half_edges[e][0]].push_back(e);
    ++excess[half_edges[e][0]], --excess[half_edges[e][1]];
  }
  std::vector<char> used(half_edges.size(), 0);
  std::vector<Loop> loops;
  const auto walk = [&](int start) {
    Loop loop;
    loop.vertices.push_back(half_edges[start][0]);
    for (int e = start;;) {
      used[e] = 1;
      const int v = half_edges[e][1];
      if (v == loop.vertices.front()) break;
      loop.vertices.push_back(v);
      auto& out = leaving[v];
      while (!out.empty() && used[out.back()]) out.pop_back();
      if (out.empty()) {
        loop.closed = false;
        break;
      }
      e = out.back();
    }
    loops.push_back(std::move(loop));
  };
  for (int e = 0; e < int(half_edges.size()); ++e)  // chains begin where more leaves than enters
    if (!used[e] && excess[half_edges[e][0]] > 0) --excess[half_edges[e][0]], walk(e);
  for (int e = 0; e < int(half_edges.size()); ++e)
    if (!used[e]) walk(e);
  return loops;
}

std::vector<std::array<int, 2>> boundary_half_edges(const Mesh& mesh) {
  std::vector<std::array<int, 2>> boundary;
  for_each_mesh_edge(sorted_half_edges(mesh), [&](auto first, auto last) {
    if (last - first == 1) boundary.push_back({first->from, first->to});
  });
  return boundary;
}

double loop_length(const Mesh& mesh, const Loop& loop) {
  double length = 0;
  for (int i = 0; i < loop.edges(); ++i)
    length += (mesh.vertices[loop.next(i)] - mesh.vertices[loop.vertices[i]]).norm();
  return length;
}

namespace {

std::vector<Vec3> samples(const Mesh& mesh, const Loop& loop) {
  constexpr int kMost = 200;
  std::vector<Vec3> s;
  const int step = (loop.size() + kMost - 1) / kMost;
  for (int i = 0; i < loop.size(); i += step) s.push_back(mesh.vertices[loop.vertices[i]]);
  return s;
}

double mean_nearest(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  double sum = 0;
  for (const Vec3& p : from) {
    double best = 1e300;
    for (const Vec3& q : to) best = std::min(best, (p - q).squaredNorm());
    sum += std::sqrt(best);
  }
  return sum / double(from.size());
}

}  // namespace

std::vector<std::array<int, 2>> match_loops(const Mesh& mesh, const std::vector<Loop>& a, const std::vector<Loop>& b,
                                            double max_gap, double& gap) {
  std::vector<std::vector<Vec3>> sa, sb;
  for (const Loop& l : a) sa.push_back(samples(mesh, l));
  for (const Loop& l : b) sb.push_back(samples(mesh, l));
  const auto boxes = [](const std::vector<std::vector<Vec3>>& samples_of) {
    std::vector<Box> b(samples_of.size());
    for (std::size_t i = 0; i < b.size(); ++i)
      for (const Vec3& p : samples_of[i]) b[i].extend(p);
    return b;
  };
  const std::vector<Box> box_a = boxes(sa), box_b = boxes(sb);
  std::vector<std::pair<double, std::array<int, 2>>> near;
  for (int i = 0; i < int(a.size()); ++i)
    for (int j = 0; j < int(b.size()); ++j) {
      // A ring that faces a chain is left to the stitching by pieces.
      if (a[i].closed != b[j].closed || box_a[i].exteriorDistance(box_b[j]) > max_gap) continue;
      const double d = std::max(mean_nearest(sa[i], sb[j]), mean_nearest(sb[j], sa[i]));
      if (d <= max_gap) near.push_back({d, {i, j}});
    }
  std::sort(near.begin(), near.end());
  std::vector<char> used_a(a.size(), 0), used_b(b.size(), 0);
  std::vector<std::array<int, 2>> pairs;
  double sum = 0, weights = 0;
  for (const auto& [d, pair] : near)
    if (!used_a[pair[0]] && !used_b[pair[1]]) {
      used_a[pair[0]] = used_b[pair[1]] = 1;
      pairs.push_back(pair);
      const double w = loop_length(mesh, a[pair[0]]);
      sum += w * d, weights += w;
    }
  gap = weights > 0 ? sum / weights : 0;
  return pairs;
}

}  // namespace parts::mesh
