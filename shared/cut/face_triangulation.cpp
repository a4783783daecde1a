// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/face_triangulation.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace parts::cut {

FaceTriangulation::FaceTriangulation() {
  for (const Point& p : {Point{0, 0}, Point{kUnit, 0}, Point{0, kUnit}}) add_point(p);
  corner_.resize(3), mate_.assign(3, -1), fixed_.assign(3, 1);
  set(0, 0, 1, 2);
}

Vec3 FaceTriangulation::barycentric(int vertex) const {
  const Point& p = points_[vertex];
  return Vec3(double(kUnit - p[0] - p[1]), double(p[0]), double(p[1])) / double(kUnit);
}

std::vector<Triangle> FaceTriangulation::triangles() const {
  std::vector<Triangle> all;
  for (std::size_t h = 0; h < corner_.size(); h += 3) all.push_back({corner_[h], corner_[h + 1], corner_[h + 2]});
  return all;
}

int FaceTriangulation::turn(const Point& a, const Point& b, const Point& c) const {
  const std::int64_t cross = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  return (cross > 0) - (cross < 0);
}

int FaceTriangulation::turn(int a, int b, int c) const { return turn(points_[a], points_[b], points_[c]); }

void FaceTriangulation::link(int h, int g) {
  mate_[h] = g;
  if (g >= 0) mate_[g] = h;
}

void FaceTriangulation::set(int triangle, int a, int b, int c) {
  const int v[3] = {a, b, c};
  for (int k = 0; k < 3; ++k) corner_[3 * triangle + k] = v[k], leaving_[v[k]] = 3 * triangle + k;
}

void FaceTriangulation::fix(int h, bool fixed) {
  fixed_[h] = fixed;
  if (mate_[h] >= 0) fixed_[mate_[h]] = fixed;
}

int FaceTriangulation::add_point(const Point& p) {
  points_.push_back(p), leaving_.push_back(-1);
  return int(points_.size()) - 1;
}

int FaceTriangulation::add_on_side(int k, std::int64_t at) {
  const Point p = k == 0 ? Point{at, 0} : k == 1 ? Point{kUnit - at, at} : Point{0, kUnit - at};
  return insert(p);
}

int FaceTriangulation::add_inside(const Vec3& barycentric) {
  Point p;
  for (int d : {0, 1}) {
    const double at = std::isfinite(barycentric[d + 1]) ? std::clamp(barycentric[d + 1], 0.0, 1.0) : 1.0 / 3;
    p[d] = std::clamp<std::int64_t>(std::llround(at * double(kUnit)), 1, kUnit - 2);
  }
  if (p[0] + p[1] >= kUnit) {  // beyond the third side: back to it, and a step inside
    const std::int64_t over = p[0] + p[1] - (kUnit - 1);
    p[0] = std::max<std::int64_t>(1, p[0] - (over + 1) / 2);
    p[1] = kUnit - 1 - p[0];
  }
  return insert(p);
}

/// The triangle that holds a point.
int FaceTriangulation::locate(const Point& p) {
  const int triangles = int(corner_.size()) / 3;
  const auto outside = [&](int t) {  // the side that the point is beyond, -1 if none
    for (int h = 3 * t; h < 3 * t + 3; ++h)
      if (turn(points_[from(h)], points_[to(h)], p) < 0) return h;
    return -1;
  };
  int t = last_;
  for (int step = 0; step < triangles; ++step) {
    const int h = outside(t);
    if (h < 0) return last_ = t;
    if (mate_[h] < 0) break;
    t = mate_[h] / 3;
  }
  for (t = 0; t < triangles && outside(t) >= 0; ++t) {  // a walk may go in circles
  }
  return last_ = t;
}

int FaceTriangulation::insert(const Point& p) {
  const int t = locate(p);
  for (int h = 3 * t; h < 3 * t + 3; ++h)
    if (points_[from(h)] == p) return from(h);
  const int vertex = add_point(p);
  for (int h = 3 * t; h < 3 * t + 3; ++h)
    if (turn(points_[from(h)], points_[to(h)], p) == 0) {
      if (mate_[h] < 0) {
        split_side(h, vertex);
      } else {
        // The triangle of no area that this makes goes when its edge is flipped.
        const bool fixed = fixed_[h];
        const int a = from(h), b = to(h);
        split_triangle(t, vertex);
        flip(edge(a, b));
        fix(edge(a, vertex), fixed), fix(edge(vertex, b), fixed);
      }
      return vertex;
    }
  split_triangle(t, vertex);
  return vertex;
}

void FaceTriangulation::split_triangle(int t, int vertex) {
  const int v[3] = {corner_[3 * t], corner_[3 * t + 1], corner_[3 * t + 2]};
  const int mate[3] = {mate_[3 * t], mate_[3 * t + 1], mate_[3 * t + 2]};
  const char fixed[3] = {fixed_[3 * t], fixed_[3 * t + 1], fixed_[3 * t + 2]};
  const int part[3] = {t, int(corner_.size()) / 3, int(corner_.size()) / 3 + 1};
  corner_.resize(corner_.size() + 6), mate_.resize(corner_.size(), -1), fixed_.resize(corner_.size(), 0);
  for (int k = 0; k < 3; ++k) {
    set(part[k], v[k], v[(k + 1) % 3], vertex);
    const int h = 3 * part[k];
    link(h, mate[k]);
    fixed_[h] = fixed[k], fixed_[h + 1] = fixed_[h + 2] = 0;
  }
  for (int k = 0; k < 3; ++k) link(3 * part[k] + 1, 3 * part[(k + 1) % 3] + 2);
}

void FaceTriangulation::split_side(int h, int vertex) {
  const int t = h / 3, n = next(h), a = from(h), b = to(h), c = apex(h), u = int(corner_.size()) / 3;
  const int mate_bc = mate_[n], mate_ca = mate_[previous(h)];
  const char fixed_bc = fixed_[n], fixed_ca = fixed_[previous(h)];
  corner_.resize(corner_.size() + 3), mate_.resize(corner_.size(), -1), fixed_.resize(corner_.size(), 0);
  set(t, a, vertex, c), set(u, vertex, b, c);
  mate_[3 * t] = -1, link(3 * t + 1, 3 * u + 2), link(3 * t + 2, mate_ca);
  mate_[3 * u] = -1, link(3 * u + 1, mate_bc);
  fixed_[3 * t] = 1, fixed_[3 * t + 1] = 0, fixed_[3 * t + 2] = fixed_ca;
  fixed_[3 * u] = 1, fixed_[3 * u + 1] = fixed_bc, fixed_[3 * u + 2] = 0;
}

/// Replaces the edge a, b of the triangles (a, b, c) and (b, a, d) by c, d.
void FaceTriangulation::flip(int h) {
  const int g = mate_[h], t = h / 3, u = g / 3, a = from(h), b = to(h), c = apex(h), d = apex(g);
  const int bc = mate_[next(h)], ca = mate_[previous(h)], ad = mate_[next(g)], db = mate_[previous(g)];
  const char fixed_bc = fixed_[next(h)], fixed_ca = fixed_[previous(h)], fixed_ad = fixed_[next(g)],
             fixed_db = fixed_[previous(g)];
  set(t, a, d, c), set(u, d, b, c);
  link(3 * t, ad), link(3 * t + 1, 3 * u + 2), link(3 * t + 2, ca);
  link(3 * u, db), link(3 * u + 1, bc);
  fixed_[3 * t] = fixed_ad, fixed_[3 * t + 1] = 0, fixed_[3 * t + 2] = fixed_ca;
  fixed_[3 * u] = fixed_db, fixed_[3 * u + 1] = fixed_bc, fixed_[3 * u + 2] = 0;
}

/// Whether the two triangles at an edge could have the other diagonal.
bool FaceTriangulation::convex(int h) const {
  const int g = mate_[h], a = from(h), b = to(h), c = apex(h), d = apex(g);
  return turn(a, d, c) > 0 && turn(d, b, c) > 0;
}

template <class Visit>
void FaceTriangulation::around(int vertex, const Visit& visit) const {
  const int first = leaving_[vertex];
  int h = first;
  do {  // clockwise
    if (visit(h)) return;
    h = mate_[h] < 0 ? -1 : next(mate_[h]);
  } while (h >= 0 && h != first);
  if (h == first) return;
  for (h = mate_[previous(first)]; h >= 0; h = mate_[previous(h)])  // and the rest
    if (visit(h)) return;
}

/// A half-edge from u to v, or from v to u on a side of the face; -1 if there is no such edge.
int FaceTriangulation::edge(int u, int v) const {
  int found = -1;
  around(u, [&](int h) {
    if (to(h) == v) found = h;
    if (apex(h) == v && mate_[previous(h)] < 0) found = previous(h);
    return found >= 0;
  });
  return found;
}

int FaceTriangulation::passed(int u, int v, std::vector<std::array<int, 2>>& edges) const {
  edges.clear();
  const auto ahead = [&](int w) {
    const Point &p = points_[u], &q = points_[v], &r = points_[w];
    return double(q[0] - p[0]) * double(r[0] - p[0]) + double(q[1] - p[1]) * double(r[1] - p[1]) > 0;
  };
  int hit = -1, h = -1;
  around(u, [&](int out) {
    const int right = to(out), left = apex(out);
    for (int w : {right, left})
      if (w == v || (turn(u, v, w) == 0 && ahead(w))) hit = w;
    if (hit < 0 && turn(u, v, right) < 0 && turn(u, v, left) > 0) h = next(out);
    return hit >= 0 || h >= 0;
  });
  if (hit >= 0 || h < 0) return hit;
  while (true) {
    edges.push_back({from(h), to(h)});
    const int g = mate_[h];
    if (g < 0) return -1;  // never, as both ends are in the face
    const int w = apex(g), side = w == v ? 0 : turn(u, v, w);
    if (side == 0) return w;
    h = side > 0 ? next(g) : previous(g);
  }
}

FaceTriangulation::Point FaceTriangulation::meeting(int u, int v, int a, int b) const {
  const auto d = [&](int from, int to, int k) { return (long double)(points_[to][k] - points_[from][k]); };
  const long double along = d(u, a, 0) * d(a, b, 1) - d(u, a, 1) * d(a, b, 0);
  const long double whole = d(u, v, 0) * d(a, b, 1) - d(u, v, 1) * d(a, b, 0);
  const long double t = whole != 0 ? along / whole : 0.5L;
  return {points_[u][0] + std::int64_t(std::llround(t * d(u, v, 0))),
          points_[u][1] + std::int64_t(std::llround(t * d(u, v, 1)))};
}

/// Flips the edges between u and v away (Sloan 1993).
void FaceTriangulation::clear_way(int u, int v, const std::vector<std::array<int, 2>>& edges) {
  std::deque<std::array<int, 2>> queue(edges.begin(), edges.end());
  for (std::size_t left = 8 * edges.size() * edges.size() + 64; !queue.empty() && left > 0; --left) {
    const auto [a, b] = queue.front();
    queue.pop_front();
    const int h = edge(a, b);
    if (h < 0 || mate_[h] < 0) continue;
    if (!convex(h)) {
      queue.push_back({a, b});
      continue;
    }
    const int c = apex(h), d = apex(mate_[h]);
    flip(h);
    if (c != u && c != v && d != u && d != v && turn(u, v, c) * turn(u, v, d) < 0) queue.push_back({c, d});
  }
}

void FaceTriangulation::constrain(int u, int v, int depth) {
  constexpr int kDeepest = 40;  // of constraints that cross where the grid ends
  std::vector<std::array<int, 2>> edges;
  while (u != v && depth < kDeepest) {
    const int w = passed(u, v, edges);
    if (w < 0) return;
    for (const auto& [a, b] : edges) {
      const int h = edge(a, b);
      if (!fixed_[h]) continue;
      const Point p = meeting(u, v, a, b);
      fix(h, false);
      const int x = insert(p);
      constrain(a, x, depth + 1), constrain(x, b, depth + 1);
      if (x != u && x != v) {
        constrain(u, x, depth + 1), constrain(x, v, depth + 1);
        return;
      }
      break;
    }
    if (passed(u, v, edges) != w) {  // changed above
      ++depth;
      continue;
    }
    clear_way(u, w, edges);
    const int h = edge(u, w);
    if (h < 0) return;
    fix(h, true);
    u = w;
  }
}

void FaceTriangulation::improve(const std::array<Vec3, 3>& corners) {
  constexpr int kRounds = 12;
  std::vector<Vec3> at;
  for (int v = 0; v < vertices(); ++v) {
    const Vec3 l = barycentric(v);
    at.push_back(l[0] * corners[0] + l[1] * corners[1] + l[2] * corners[2]);
  }
  const auto angle = [&](int v, int p, int q) {
    const Vec3 x = at[p] - at[v], y = at[q] - at[v];
    return std::atan2(x.cross(y).norm(), x.dot(y));
  };
  bool flipped = true;
  for (int round = 0; round < kRounds && flipped; ++round) {
    flipped = false;
    for (int h = 0; h < int(corner_.size()); ++h) {
      if (mate_[h] < h || fixed_[h] || !convex(h)) continue;
      const int a = from(h), b = to(h);
      if (angle(apex(h), a, b) + angle(apex(mate_[h]), a, b) <= M_PI + 1e-6) continue;
      flip(h);
      flipped = true;
    }
  }
}

}  // namespace parts::cut
