// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/remesh.h"

#include <algorithm>
#include <cmath>

#include "parts/mesh/attributes.h"

namespace parts::test {
namespace {

/// Collapses short edges, so that faces are as large as what they show allows.
class Simplifier {
 public:
  Simplifier(Mesh mesh, const ScalarField& field, const ScalarField& length)
      : mesh_(std::move(mesh)), field_(field), length_(length), around_(mesh_.vertices.size()) {
    for (int f = 0; f < mesh_.face_count(); ++f)
      for (int v : mesh_.faces[f]) around_[v].push_back(f);
  }

  Mesh mesh() {
    // Shortest first, in rounds: edges double in length every other round.
    for (double share = 0.25; share <= 1; share *= std::sqrt(2.0)) {
      for (int v = 0; v < mesh_.vertex_count(); ++v)
        while (collapse_shortest(v, share)) {
        }
      for (int i = 0; i < 2; ++i) flip_edges(), relax();
    }
    for (int i = 0; i < 5; ++i) flip_edges(), relax();
    std::vector<char> alive(mesh_.faces.size());
    for (int f = 0; f < mesh_.face_count(); ++f) alive[f] = mesh_.faces[f][0] >= 0;
    return mesh::take_faces(mesh_, alive);
  }

 private:
  std::vector<int> neighbours(int v) const {
    std::vector<int> n;
    for (int f : around_[v])
      for (int u : mesh_.faces[f])
        if (u != v) n.push_back(u);
    std::sort(n.begin(), n.end());
    n.erase(std::unique(n.begin(), n.end()), n.end());
    return n;
  }
  bool collapse_shortest(int v, double share) {
    int best = -1;
    double shortest = share * length_(mesh_.vertices[v]);
    const std::vector<int> ring = neighbours(v);
    for (int u : ring) {
      const double length = (mesh_.vertices[u] - mesh_.vertices[v]).norm();
      if (length < shortest && allowed(u, ring)) shortest = length, best = u;
    }
    if (best < 0) return false;
    const Vec3 old_v = mesh_.vertices[v], middle = project(0.5 * (old_v + mesh_.vertices[best]));
    if (turns_over(v, best, middle) || turns_over(best, v, middle)) return false;
    merge(v, best, middle);
    return true;
  }
  /// Whether the surface stays a manifold: the only common neighbours are across the edge's two faces.
  bool allowed(int u, const std::vector<int>& ring) const {
    const std::vector<int> other = neighbours(u);
    std::vector<int> common;
    std::set_intersection(ring.begin(), ring.end(), other.begin(), other.end(), std::back_inserter(common));
    return common.size() == 2 && ring.size() > 3 && other.size() > 3 && ring.size() + other.size() < 16;
  }
  bool turns_over(int v, int partner, const Vec3& to) const {
    const Vec3 outward = gradient(field_, to).normalized();
    for (int f : around_[v]) {
      const Triangle& t = mesh_.faces[f];
      if (t[0] == partner || t[1] == partner || t[2] == partner) continue;
      std::array<Vec3, 3> c{mesh_.corner(f, 0), mesh_.corner(f, 1), mesh_.corner(f, 2)};
      const Vec3 before = (c[1] - c[0]).cross(c[2] - c[0]);
      for (int k = 0; k < 3; ++k)
        if (t[k] == v) c[k] = to;
      const Vec3 after = (c[1] - c[0]).cross(c[2] - c[0]);
      if (after.dot(before) < 0.5 * after.norm() * before.norm() || after.dot(outward) < 0.1 * after.norm())
        return true;
    }
    return false;
  }
  void merge(int v, int u, const Vec3& to) {
    for (int f : around_[u]) {
      Triangle& t = mesh_.faces[f];
      if (t[0] == v || t[1] == v || t[2] == v) {
        for (int w : t)
          if (w != u) around_[w].erase(std::find(around_[w].begin(), around_[w].end(), f));
        t = {-1, -1, -1};
        continue;
      }
      for (int& w : t)
        if (w == u) w = v;
      around_[v].push_back(f);
    }
    around_[u].clear();
    mesh_.vertices[v] = to;
  }
  void relax() {
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      if (around_[v].empty()) continue;
      const std::vector<int> ring = neighbours(v);
      Vec3 mean = Vec3::Zero();
      for (int u : ring) mean += mesh_.vertices[u];
      const Vec3 to = project(0.5 * (mesh_.vertices[v] + mean / double(ring.size())));
      if (!turns_over(v, -1, to)) mesh_.vertices[v] = to;
    }
  }
  /// Edges whose opposite angles exceed 180 degrees together are turned.
  void flip_edges() {
    for (int f = 0; f < mesh_.face_count(); ++f)
      for (int k = 0; k < 3 && mesh_.faces[f][0] >= 0; ++k) {
        const int a = mesh_.faces[f][k], b = mesh_.faces[f][(k + 1) % 3], c = mesh_.faces[f][(k + 2) % 3];
        const auto [g, d] = across(a, b);
        if (g != f) flip(f, g, a, b, c, d);
      }
  }
  /// The face with an edge from b to a, and its third vertex.
  std::pair<int, int> across(int a, int b) const {
    for (int g : around_[b])
      for (int j = 0; j < 3; ++j)
        if (mesh_.faces[g][j] == b && mesh_.faces[g][(j + 1) % 3] == a) return {g, mesh_.faces[g][(j + 2) % 3]};
    return {-1, -1};
  }
  void flip(int f, int g, int a, int b, int c, int d) {
    const auto at = [&](int v) { return mesh_.vertices[v]; };
    const auto angle = [&](int v) {
      return std::atan2((at(a) - at(v)).cross(at(b) - at(v)).norm(), (at(a) - at(v)).dot(at(b) - at(v)));
    };
    const auto normal = [&](int i, int j, int k) { return (at(j) - at(i)).cross(at(k) - at(i)).normalized().eval(); };
    if (angle(c) + angle(d) <= M_PI + 1e-6) return;
    if (normal(a, b, c).dot(normal(b, a, d)) < 0.8 || normal(c, a, d).dot(normal(d, b, c)) < 0.8) return;
    if (around_[a].size() <= 3 || around_[b].size() <= 3) return;
    const std::vector<int> ring = neighbours(c);
    if (std::binary_search(ring.begin(), ring.end(), d)) return;
    mesh_.faces[f] = {c, a, d}, mesh_.faces[g] = {d, b, c};
    const auto leave = [&](int v, int face) {
      around_[v].erase(std::find(around_[v].begin(), around_[v].end(), face));
    };
    leave(a, g), leave(b, f);
    around_[c].push_back(g), around_[d].push_back(f);
  }
  Vec3 project(Vec3 p) const {
    const Vec3 g = gradient(field_, p);
    return g.squaredNorm() > 0.04 ? Vec3(p - std::clamp(field_(p) / g.squaredNorm(), -0.01, 0.01) * g) : p;
  }

  Mesh mesh_;
  const ScalarField &field_, &length_;
  std::vector<std::vector<int>> around_;  ///< faces of a vertex
};

}  // namespace

Vec3 gradient(const ScalarField& field, const Vec3& p) {
  constexpr double h = 1e-4;
  Vec3 g;
  for (int d = 0; d < 3; ++d) g[d] = (field(p + h * Vec3::Unit(d)) - field(p - h * Vec3::Unit(d))) / (2 * h);
  return g;
}

Mesh simplified(const Mesh& mesh, const ScalarField& field, const ScalarField& length) {
  return Simplifier(mesh, field, length).mesh();
}

}  // namespace parts::test
