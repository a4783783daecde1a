// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/weld.h"

#include <algorithm>
#include <map>
#include <set>

#include "parts/seam/contours.h"

namespace parts::seam {
namespace {

class Welder {
 public:
  Welder(Joined& j, double step)
      : j_(j), step_(step), twin_(j.mesh.vertices.size(), -1), of_b_(j.mesh.vertices.size(), 0) {
    for (int f = 0; f < j.mesh.face_count(); ++f)
      for (int v : j.mesh.faces[f]) of_b_[v] = j.tag[f] == 1;
  }

  void run(SeamReport& report) {
    find_twins();
    while (drop_partial_loops() || drop_conflicts()) {
    }
    merge(report);
  }

 private:
  const Vec3& at(int v) const { return j_.mesh.vertices[v]; }
  bool made(const std::array<int, 2>& e) const { return !contains(j_.own, e); }

  /// Pairs the contours' vertices that lie in one place, the nearest of each.
  void find_twins() {
    std::vector<std::pair<double, int>> of_b;
    for_each_made(j_.loops_b, [&](const auto& e) {
      half_edges_b_.insert(e);
      for (int v : e) of_b.emplace_back(at(v).x(), v);
    });
    std::sort(of_b.begin(), of_b.end());
    of_b.erase(std::unique(of_b.begin(), of_b.end()), of_b.end());
    std::set<int> of_a;
    for_each_made(j_.loops_a, [&](const auto& e) { of_a.insert(e.begin(), e.end()); });
    for (int u : of_a) {
      double least = step_;
      int nearest = -1;
      for (auto it = std::lower_bound(of_b.begin(), of_b.end(), std::pair(at(u).x() - step_, -1));
           it != of_b.end() && it->first <= at(u).x() + step_; ++it)
        if (const double d = (at(it->second) - at(u)).norm(); d <= least && twin_[it->second] < 0)
          least = d, nearest = it->second;
      if (nearest < 0 || (j_.fixed[u] && j_.fixed[nearest] && at(u) != at(nearest))) continue;
      twin_[u] = nearest, twin_[nearest] = u;
    }
  }

  template <class Visit>
  void for_each_made(const std::vector<mesh::Loop>& loops, const Visit& visit) const {
    for (const mesh::Loop& l : loops)
      for_each_half_edge(l, [&](const auto& e) {
        if (made(e)) visit(e);
      });
  }

  bool welds(const std::array<int, 2>& e) const {
    return twin_[e[0]] >= 0 && twin_[e[1]] >= 0 && half_edges_b_.count({twin_[e[1]], twin_[e[0]]}) > 0;
  }

  void part(int v) {
    if (v < 0 || twin_[v] < 0) return;
    twin_[twin_[v]] = -1, twin_[v] = -1;
  }

  /// Only contours that the other has as a whole are welded. @return whether any was not
  bool drop_partial_loops() {
    std::set<std::array<int, 2>> half_edges_a;
    for_each_made(j_.loops_a, [&](const auto& e) { half_edges_a.insert(e); });
    bool any = false;
    const auto drop = [&](const std::vector<mesh::Loop>& loops, const auto& whole_edge) {
      for (const mesh::Loop& l : loops) {
        bool whole = true, twins = false;
        for_each_half_edge(l, [&](const auto& e) {
          twins |= twin_[e[0]] >= 0 || twin_[e[1]] >= 0;
          whole = whole && (!made(e) || whole_edge(e));
        });
        if (whole || !twins) continue;
        for (int v : l.vertices) part(v);
        any = true;
      }
    };
    drop(j_.loops_a, [&](const auto& e) { return welds(e); });
    drop(j_.loops_b, [&](const auto& e) {
      return twin_[e[0]] >= 0 && twin_[e[1]] >= 0 && half_edges_a.count({twin_[e[1]], twin_[e[0]]}) > 0;
    });
    return any;
  }

  /// No edge may get more than two faces.
  bool drop_conflicts() {
    std::map<std::array<int, 2>, int> faces;
    for (const Triangle& f : j_.mesh.faces)
      for (int k = 0; k < 3; ++k) {
        const int u = merged(f[k]), v = merged(f[(k + 1) % 3]);
        if (twin_[u] >= 0 && twin_[v] >= 0) ++faces[{u, v}];
      }
    bool any = false;
    for (const auto& [e, count] : faces)
      if (count > 1 && twin_[e[0]] >= 0) part(e[0]), any = true;
    return any;
  }

  int merged(int v) const { return twin_[v] >= 0 && of_b_[v] ? twin_[v] : v; }

  void merge(SeamReport& report) {
    for (int v = 0; v < int(twin_.size()); ++v) {
      const int u = merged(v);
      if (u == v) continue;
      if (j_.fixed[v]) j_.mesh.vertices[u] = j_.mesh.vertices[v], j_.fixed[u] = j_.fixed[v];
      j_.seam[u] |= j_.seam[v] | kWelded;
    }
    for (Triangle& f : j_.mesh.faces)
      for (int& v : f) v = merged(v);
    std::vector<char> still(twin_.size(), 0);
    for (std::size_t v = 0; v < twin_.size(); ++v) still[v] = twin_[v] >= 0 && !of_b_[v];
    for (int f = 0; f < j_.mesh.face_count(); ++f)
      for (int v : j_.mesh.faces[f]) still[v] = still[v] && j_.same[f];
    for (std::size_t v = 0; v < still.size(); ++v)
      if (still[v]) j_.fixed[v] = 1;
    take_out(j_.loops_a, &report), take_out(j_.loops_b, nullptr);
  }

  /// Takes the welded half-edges out of contours.
  void take_out(std::vector<mesh::Loop>& loops, SeamReport* report) {
    std::vector<mesh::Loop> left;
    for (mesh::Loop& l : loops) {
      bool any_made = false, all = true;
      for_each_half_edge(l, [&](const auto& e) {
        if (!made(e)) return;
        any_made = true, all = all && twin_[e[0]] >= 0 && twin_[e[1]] >= 0;
      });
      if (!any_made || !all) {
        left.push_back(std::move(l));
        continue;
      }
      if (!report) continue;
      ++report->loops_joined, report->seam_length += mesh::loop_length(j_.mesh, l);
    }
    loops.swap(left);
  }

  Joined& j_;
  const double step_;
  std::vector<int> twin_;   ///< per vertex: the other model's at its place, -1
  std::vector<char> of_b_;  ///< per vertex
  std::set<std::array<int, 2>> half_edges_b_;
};

}  // namespace

void weld_borders(Joined& joined, double step, SeamReport& report) { Welder(joined, step).run(report); }

}  // namespace parts::seam
