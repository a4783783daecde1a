// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/flaw.h"

#include <algorithm>
#include <cmath>

#include "parts/base/disjoint_sets.h"
#include "parts/base/median.h"
#include "parts/cut/max_flow.h"
#include "parts/mesh/edges.h"
#include "parts/spatial/closest_face.h"

namespace parts::mend {
namespace {

/// How close a point of the region is to those of its sides that the surface
/// goes through: 0 on a side, 1 at the centre.
class Depth {
 public:
  Depth(const Mesh& scan, const Box& box) : box_(box), half_(box.sizes() / 2) {
    for (int f = 0; f < scan.face_count(); ++f) {
      const Box b = scan.face_box(f);
      if (!box.intersects(b)) continue;
      for (int d = 0; d < 3; ++d) {
        crossed_[0][d] |= b.min()[d] < box.min()[d];
        crossed_[1][d] |= b.max()[d] > box.max()[d];
      }
    }
    any_ = false;
    for (int side = 0; side < 2; ++side)
      for (int d = 0; d < 3; ++d) any_ |= crossed_[side][d];
  }
  double operator()(const Vec3& p) const {
    double least = 1;
    for (int d = 0; d < 3; ++d) {
      if (!any_ || crossed_[0][d]) least = std::min(least, (p[d] - box_.min()[d]) / half_[d]);
      if (!any_ || crossed_[1][d]) least = std::min(least, (box_.max()[d] - p[d]) / half_[d]);
    }
    return least;
  }

 private:
  Box box_;
  Vec3 half_;
  std::array<std::array<bool, 3>, 2> crossed_{};
  bool any_;
};

/// Pieces that the cut has left within what goes go too.
void leave_no_island(const Mesh& scan, const std::vector<char>& keep, std::vector<char>& replaced) {
  DisjointSets pieces(scan.face_count());
  const std::vector<mesh::HalfEdge> edges = mesh::sorted_half_edges(scan);
  mesh::for_each_mesh_edge(edges, [&](auto first, auto last) {
    for (auto e = first + 1; e < last; ++e)
      if (!replaced[first->face] && !replaced[e->face]) pieces.unite(first->face, e->face);
  });
  std::vector<char> kept(scan.faces.size(), 0), cut(scan.faces.size(), 0);
  for (int f = 0; f < scan.face_count(); ++f)
    if (keep[f]) kept[pieces.find(f)] = 1;
  mesh::for_each_mesh_edge(edges, [&](auto first, auto last) {
    for (auto e = first + 1; e < last; ++e) {
      if (replaced[first->face] && !replaced[e->face]) cut[pieces.find(e->face)] = 1;
      if (replaced[e->face] && !replaced[first->face]) cut[pieces.find(first->face)] = 1;
    }
  });
  for (int f = 0; f < scan.face_count(); ++f)
    if (const int piece = pieces.find(f); cut[piece] && !kept[piece]) replaced[f] = 1;
}

/// Faces of which a vertex would be left with several fans go too.
void leave_no_pinch(const Mesh& scan, const std::vector<char>& keep, std::vector<char>& replaced) {
  std::vector<std::vector<int>> around(scan.vertices.size());
  for (int f = 0; f < scan.face_count(); ++f)
    for (int v : scan.faces[f]) around[v].push_back(f);
  const auto fans = [&](int v) {
    std::vector<int> rest;
    for (int f : around[v])
      if (!replaced[f]) rest.push_back(f);
    int count = 0;
    while (!rest.empty()) {
      ++count;
      std::vector<int> open{rest.back()};
      rest.pop_back();
      while (!open.empty()) {
        const Triangle t = scan.faces[open.back()];
        open.pop_back();
        for (std::size_t i = 0; i < rest.size();) {
          int shared = 0;
          for (int a : t)
            for (int b : scan.faces[rest[i]]) shared += a == b;
          if (shared >= 2) {
            open.push_back(rest[i]);
            rest[i] = rest.back(), rest.pop_back();
          } else {
            ++i;
          }
        }
      }
    }
    return count;
  };
  std::vector<int> check;
  for (int v = 0; v < scan.vertex_count(); ++v)
    if (std::any_of(around[v].begin(), around[v].end(), [&](int f) { return replaced[f] != 0; })) check.push_back(v);
  while (!check.empty()) {
    const int v = check.back();
    check.pop_back();
    if (fans(v) < 2) continue;
    for (int f : around[v])
      if (!replaced[f] && !keep[f]) {
        replaced[f] = 1;
        for (int u : scan.faces[f])
          if (u != v) check.push_back(u);
      }
  }
}

}  // namespace

FlawConstraints flaw_constraints(const Mesh& scan, const Region& region, const std::vector<char>& flaw, double share) {
  FlawConstraints c{std::vector<char>(scan.faces.size(), 0), flaw, flaw};
  const Depth depth(scan, region.box);
  const bool known = !flaw.empty();
  c.flaw.resize(scan.faces.size(), 0), c.suspect.resize(scan.faces.size(), 0);
  const Vec3 center = region.box.center(), half = region.box.sizes() / 2;
  std::vector<double> away(scan.faces.size(), 1e300);  // from the centre
  double least = 1e300;
  for (int f = 0; f < scan.face_count(); ++f) {
    const bool inside = region.box.contains(scan.face_box(f));
    c.keep[f] = !(known && flaw[f]) && (!inside || depth(scan.center(f)) < share);
    if (!inside || known) continue;
    c.suspect[f] = !c.keep[f];
    away[f] = (scan.center(f) - center).cwiseQuotient(half).norm();
    least = std::min(least, away[f]);
  }
  if (known) return c;
  for (int f = 0; f < scan.face_count(); ++f)
    if (away[f] <= std::max(least, std::min(share, 0.9))) c.flaw[f] = 1, c.keep[f] = 0;
  return c;
}

std::vector<char> cut_out_flaw(const Mesh& scan, const Region& region, FlawConstraints c, const Mesh& model) {
  const spatial::ClosestFace on_model(model);
  // How far the two surfaces are apart, at the vertices of the region.
  std::vector<double> apart(scan.vertices.size(), -1), good;
  const auto fill_in = [&](int v) {
    if (apart[v] < 0) apart[v] = on_model.empty() ? 0 : on_model(scan.vertices[v]).distance;
    return apart[v];
  };
  Box near = region.box;
  near.min().array() -= 0.1 * region.size(), near.max().array() += 0.1 * region.size();
  for (int f = 0; f < scan.face_count(); ++f)
    if (near.intersects(scan.face_box(f)) && c.keep[f])
      for (int v : scan.faces[f]) good.push_back(fill_in(v));
  const double usual = std::max(median(good), 1e-3 * region.size());
  if (region.flaw.empty())
    for (int f = 0; f < scan.face_count(); ++f) {
      if (c.keep[f] || !region.box.contains(scan.face_box(f))) continue;
      double most = 0;
      for (int v : scan.faces[f]) most = std::max(most, fill_in(v));
      if (most > 6 * usual) c.flaw[f] = 1;
    }

  cut::FlowGraph graph(scan.face_count(), 2 * scan.face_count());
  graph.add_node(scan.face_count());
  for (int f = 0; f < scan.face_count(); ++f)
    if (c.keep[f])
      graph.add_tweights(f, cut::kUncuttableTerminal, 0);
    else if (c.flaw[f])
      graph.add_tweights(f, 0, cut::kUncuttableTerminal);
  mesh::for_each_mesh_edge(mesh::sorted_half_edges(scan), [&](auto first, auto last) {
    for (auto e = first + 1; e < last; ++e) {
      if (c.keep[first->face] && c.keep[e->face]) continue;
      const double length = (scan.vertices[first->from] - scan.vertices[first->to]).norm();
      const double gap = 0.5 * (fill_in(first->from) + fill_in(first->to));
      const double cost = length / region.size() * (0.3 + gap / usual);
      const int capacity = int(std::clamp(1e5 * cost, 1.0, 1e8));
      graph.add_edge(first->face, e->face, capacity, capacity);
    }
  });
  graph.maxflow();
  std::vector<char> replaced(scan.faces.size());
  for (int f = 0; f < scan.face_count(); ++f)
    replaced[f] = !c.keep[f] && (c.flaw[f] || graph.what_segment(f, cut::FlowGraph::SOURCE) == cut::FlowGraph::SINK);
  leave_no_island(scan, c.keep, replaced);
  leave_no_pinch(scan, c.keep, replaced);
  return replaced;
}

}  // namespace parts::mend
