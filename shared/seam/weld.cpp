// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/weld.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "parts/seam/cap.h"
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

  bool part(int v) {
    if (twin_[v] < 0) return false;
    twin_[twin_[v]] = -1, twin_[v] = -1;
    return true;
  }

  /// Of a contour that the other model has but for a few short stretches the rest is welded; others are not.
  /// @return whether anything was parted
  bool drop_partial_loops() {
    std::set<std::array<int, 2>> half_edges_a;
    for_each_made(j_.loops_a, [&](const auto& e) { half_edges_a.insert(e); });
    bool any = false;
    const auto drop = [&](const std::vector<mesh::Loop>& loops, const auto& welds) {
      for (const mesh::Loop& l : loops) {
        std::vector<char> welded, own;
        std::vector<int> lonely;  // vertices at no edge that is welded
        for_each_half_edge(l, [&](const auto& e) { own.push_back(!made(e)), welded.push_back(made(e) && welds(e)); });
        const int n = int(welded.size());
        for (int i = 0; i < l.size(); ++i)
          if (!(i < n && welded[i]) && !((l.closed || i > 0) && welded[(i + n - 1) % n])) lonely.push_back(i);
        if (!mostly(welded, own, l.closed)) {
          lonely.resize(l.size());
          std::iota(lonely.begin(), lonely.end(), 0);
        }
        for (int i : lonely) any |= part(l.vertices[i]);
      }
    };
    drop(j_.loops_a, [&](const auto& e) { return welds(e); });
    drop(j_.loops_b, [&](const auto& e) {
      return twin_[e[0]] >= 0 && twin_[e[1]] >= 0 && half_edges_a.count({twin_[e[1]], twin_[e[0]]}) > 0;
    });
    return any;
  }

  /// Whether all that is not welded is in short stretches between what is.
  static bool mostly(const std::vector<char>& welded, const std::vector<char>& own, bool closed) {
    constexpr int kShort = 8;  // half-edges
    const int n = int(welded.size());
    const bool all_made = std::find(own.begin(), own.end(), 1) == own.end();
    bool whole = true;
    for (int i = 0; i < n; ++i) whole = whole && (own[i] || welded[i]);
    if (whole || !closed || !all_made) return whole;
    const int first = int(std::find(welded.begin(), welded.end(), 1) - welded.begin());
    int longest = 0, run = 0;
    for (int i = 0; i < n; ++i) {
      run = welded[(first + i) % n] ? 0 : run + 1;
      longest = std::max(longest, run);
    }
    return longest <= kShort && 2 * std::count(welded.begin(), welded.end(), 1) > n;
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
      if (count > 1) any |= part(e[0]);
    return any;
  }

  int merged(int v) const { return twin_[v] >= 0 && of_b_[v] ? twin_[v] : v; }

  void merge(SeamReport& report) {
    for_each_made(j_.loops_a, [&](const auto& e) {
      if (welds(e)) welded_.insert(e), welded_.insert({e[1], e[0]});
    });
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
      if (still[v]) j_.fixed[v] = 1, j_.seam[v] |= kStill;
    HalfEdges left;
    take_out(j_.loops_a, left, &report), take_out(j_.loops_b, left, nullptr);
    close(left);
  }

  /// Takes contours that are welded out; `left` gets what of them is not.
  void take_out(std::vector<mesh::Loop>& loops, HalfEdges& left, SeamReport* report) {
    const auto welded = [&](const std::array<int, 2>& e) { return welded_.count({merged(e[0]), merged(e[1])}) > 0; };
    std::vector<mesh::Loop> others;
    for (mesh::Loop& l : loops) {
      HalfEdges open;
      bool any = false;
      for_each_half_edge(l, [&](const auto& e) {
        if (!made(e)) return;
        if (welded(e))
          any = true;
        else
          open.push_back({merged(e[0]), merged(e[1])});
      });
      if (!any) {
        others.push_back(std::move(l));
        continue;
      }
      left.insert(left.end(), open.begin(), open.end());
      if (report) ++report->loops_joined, report->seam_length += mesh::loop_length(j_.mesh, l);
    }
    loops.swap(others);
  }

  /// Closes the slits between what is welded.
  void close(const HalfEdges& left) {
    if (left.empty()) return;
    cap(j_.mesh, mesh::trace_loops(left), j_.like);
    j_.tag.resize(j_.mesh.faces.size(), 2), j_.same.resize(j_.mesh.faces.size(), 0);
    const std::size_t vertices = j_.mesh.vertices.size();
    j_.seam.resize(vertices, kBorderA | kBorderB), j_.fixed.resize(vertices, 0), j_.closed.resize(vertices, 1);
    j_.like.resize(vertices, j_.mesh.face_count() - 1);
  }

  Joined& j_;
  const double step_;
  std::vector<int> twin_;   ///< per vertex: the other model's at its place, -1
  std::vector<char> of_b_;  ///< per vertex
  std::set<std::array<int, 2>> half_edges_b_;
  std::set<std::array<int, 2>> welded_;  ///< both ways, A's vertices
};

}  // namespace

void weld_borders(Joined& joined, double step, SeamReport& report) { Welder(joined, step).run(report); }

}  // namespace parts::seam
