// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/stitch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "parts/mesh/attributes.h"

namespace parts::seam {
namespace {

/// Indices (in a, in b) of the nearest vertices of two polylines.
std::array<int, 2> nearest_pair(const Mesh& mesh, const std::vector<int>& a, const std::vector<int>& b) {
  std::array<int, 2> best{0, 0};
  double least = 1e300;
  for (int i = 0; i < int(a.size()); ++i)
    for (int j = 0; j < int(b.size()); ++j)
      if (const double d = (mesh.vertices[a[i]] - mesh.vertices[b[j]]).squaredNorm(); d < least)
        least = d, best = {i, j};
  return best;
}

/// Which polyline advances at each step of the strip, from (0, 0) to the ends:
/// the path through the table of cross edges with the smallest sum of lengths.
std::vector<char> shortest_strip(const Mesh& mesh, const std::vector<int>& a, const std::vector<int>& b) {
  const int m = int(a.size()), n = int(b.size());
  // A strip that runs along one whole side before it moves on the other uses
  // a cross edge twice; so do two strips that end at the same one.
  const bool rings = a.front() == a.back() && b.front() == b.back();
  const auto doubles = [&](int i, int j) {
    if (!rings) return (i == 0 && j == n - 1) || (i == m - 1 && j == 0);
    return (i == 0 && j > 1) || (j == 0 && i > 1) || (i == m - 1 && j < n - 2) || (j == n - 1 && i < m - 2);
  };
  const auto cross = [&](int i, int j) {
    return (mesh.vertices[a[i]] - mesh.vertices[b[j]]).norm() + (doubles(i, j) ? 1e100 : 0);
  };
  // Very long contours are searched near the diagonal only, to bound the table.
  constexpr long kTable = 40'000'000;
  const int half = long(m) * n <= kTable ? n : std::max<int>(64, int(kTable / m / 2));
  const auto from = [&](int i) { return std::max(0, int(long(i) * n / m) - half); };
  const auto to = [&](int i) { return std::min(n - 1, int(long(i + 1) * n / m) + half); };
  std::vector<std::vector<char>> by_a(m);  // whether the step into (i, j) advanced a
  std::vector<double> last(n, 1e300), row(n, 1e300);
  for (int i = 0; i < m; ++i) {
    std::fill(row.begin(), row.end(), 1e300);
    by_a[i].resize(to(i) - from(i) + 1);
    for (int j = from(i); j <= to(i); ++j) {
      const double via_a = i > 0 ? last[j] : 1e300, via_b = j > from(i) ? row[j - 1] : 1e300;
      by_a[i][j - from(i)] = via_a <= via_b;
      row[j] = (i == 0 && j == 0 ? 0 : std::min(via_a, via_b)) + cross(i, j);
    }
    last.swap(row);
  }
  std::vector<char> steps;
  for (int i = m - 1, j = n - 1; i > 0 || j > 0;) {
    const bool a_advanced = j == 0 || (i > 0 && by_a[i][j - from(i)]);
    steps.push_back(a_advanced);
    --(a_advanced ? i : j);
  }
  std::reverse(steps.begin(), steps.end());
  return steps;
}

/// The contour as an open polyline; a closed one from vertex `start` around to it.
std::vector<int> unrolled(const mesh::Loop& loop, int start) {
  std::vector<int> v = loop.vertices;
  if (!loop.closed) return v;
  std::rotate(v.begin(), v.begin() + start, v.end());
  v.push_back(v.front());
  return v;
}

/// A contour by arc length.
class Polyline {
 public:
  Polyline(const Mesh& mesh, const mesh::Loop& loop) : closed_(loop.closed) {
    for (int v : loop.vertices) points_.push_back(mesh.vertices[v]);
    if (closed_) points_.push_back(points_.front());
    at_.push_back(0);
    for (std::size_t i = 1; i < points_.size(); ++i) at_.push_back(at_.back() + (points_[i] - points_[i - 1]).norm());
  }
  double length() const { return at_.back(); }
  Vec3 point(double at) const {
    if (closed_ && at > length()) at -= length();
    const std::size_t i = std::upper_bound(at_.begin(), at_.end(), at) - at_.begin();
    if (i >= points_.size()) return points_.back();
    return points_[i - 1] + (at - at_[i - 1]) / (at_[i] - at_[i - 1]) * (points_[i] - points_[i - 1]);
  }
  /// The unit direction to the point a tenth of the length on.
  Vec3 ahead(double at) const {
    const double step = 0.1 * length();
    if (!closed_) at = std::min(at, length() - step);
    return (point(at + step) - point(at)).normalized();
  }
  /// Where the point nearest to x is.
  double nearest(const Vec3& x) const {
    double best = 0, least = std::numeric_limits<double>::max();
    for (std::size_t i = 1; i < points_.size(); ++i) {
      const Vec3 d = points_[i] - points_[i - 1];
      const double t = std::clamp((x - points_[i - 1]).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0);
      if (const double r = (points_[i - 1] + t * d - x).squaredNorm(); r < least)
        least = r, best = at_[i - 1] + t * (at_[i] - at_[i - 1]);
    }
    return best;
  }

 private:
  bool closed_;
  std::vector<Vec3> points_;
  std::vector<double> at_;
};

}  // namespace

double direction_agreement(const Mesh& mesh, const mesh::Loop& a, const mesh::Loop& b) {
  constexpr int kStarts = 32;
  const Polyline pa(mesh, a), pb(mesh, b);
  double sum = 0;
  for (int s = 0; s < kStarts; ++s) {
    const double at = pa.length() * s / kStarts;
    sum += pa.ahead(at).dot(pb.ahead(pb.nearest(pa.point(at))));
  }
  return sum / kStarts;
}

namespace {

/// Zippers two polylines that run the same way.
void zipper_lines(Mesh& mesh, const std::vector<int>& p, const std::vector<int>& q, const std::vector<int>& like) {
  int i = 0, j = 0;
  for (const char p_advances : shortest_strip(mesh, p, q)) {
    if (p_advances) {
      mesh::add_face_like(mesh, like[p[i]], {p[i + 1], p[i], q[j]});
      ++i;
    } else {
      mesh::add_face_like(mesh, like[q[j]], {q[j], q[j + 1], p[i]});
      ++j;
    }
  }
}

/// A vertex on one of several contours.
struct Place {
  int loop, at;
};

std::vector<Place> places(const std::vector<mesh::Loop>& loops) {
  std::vector<Place> all;
  for (int l = 0; l < int(loops.size()); ++l)
    for (int k = 0; k < loops[l].size(); ++k) all.push_back({l, k});
  return all;
}

/// The contour's vertices from place `from` on to place `to` (once around if they are the same).
std::vector<int> arc(const mesh::Loop& loop, int from, int to) {
  std::vector<int> v{loop.vertices[from]};
  do {
    from = (from + 1) % loop.size();
    v.push_back(loop.vertices[from]);
  } while (from != to);
  return v;
}

}  // namespace

void zipper(Mesh& mesh, const mesh::Loop& a, const mesh::Loop& b, const std::vector<int>& like) {
  mesh::Loop back = b;
  std::reverse(back.vertices.begin(), back.vertices.end());
  const auto [i, j] = nearest_pair(mesh, a.vertices, back.vertices);
  zipper_lines(mesh, unrolled(a, i), unrolled(back, j), like);
}

ZipperedPieces zipper_pieces(Mesh& mesh, const std::vector<mesh::Loop>& a, const std::vector<mesh::Loop>& b,
                             double max_gap, const std::vector<int>& like) {
  const std::vector<Place> in_a = places(a), in_b = places(b);
  const auto nearest = [&](const std::vector<Place>& from, const std::vector<mesh::Loop>& from_loops,
                           const std::vector<Place>& to, const std::vector<mesh::Loop>& to_loops) {
    std::vector<int> found;
    for (const Place& p : from) {
      const Vec3& x = mesh.vertices[from_loops[p.loop].vertices[p.at]];
      double least = max_gap * max_gap;
      int best = -1;
      for (int k = 0; k < int(to.size()); ++k)
        if (const double d = (mesh.vertices[to_loops[to[k].loop].vertices[to[k].at]] - x).squaredNorm(); d < least)
          least = d, best = k;
      found.push_back(best);
    }
    return found;
  };
  const std::vector<int> to_b = nearest(in_a, a, in_b, b), to_a = nearest(in_b, b, in_a, a);
  const auto bridged_a = [&](int k) { return to_b[k] >= 0 && to_a[to_b[k]] == k; };
  const auto bridged_b = [&](int k) { return to_a[k] >= 0 && to_b[to_a[k]] == k; };
  // The next bridge along a contour; places of one contour are consecutive.
  const auto next_bridge = [](const std::vector<Place>& all, const std::vector<mesh::Loop>& loops, int k,
                              const auto& bridged) {
    const int size = loops[all[k].loop].size(), first = k - all[k].at;
    int at = all[k].at;
    do at = (at + 1) % size;
    while (!bridged(first + at));
    return first + at;
  };

  ZipperedPieces pieces;
  std::vector<std::array<int, 2>> open;  // half-edges that faces have no opposite for
  std::vector<char> filled_a(in_a.size(), 0), filled_b(in_b.size(), 0), starts(in_a.size(), 0), ends(in_a.size(), 0);
  for (int k = 0; k < int(in_a.size()); ++k) {
    if (!bridged_a(k)) continue;
    const mesh::Loop &la = a[in_a[k].loop], &lb = b[in_b[to_b[k]].loop];
    if (!la.closed || !lb.closed) continue;
    const int next = next_bridge(in_a, a, k, bridged_a);
    if (next_bridge(in_b, b, to_b[next], bridged_b) != to_b[k]) continue;
    const std::vector<int> p = arc(la, in_a[k].at, in_a[next].at);
    std::vector<int> q = arc(lb, in_b[to_b[next]].at, in_b[to_b[k]].at);
    for (std::size_t s = 0, at = in_a[k].at; s + 1 < p.size(); ++s, at = (at + 1) % la.size())
      filled_a[k - in_a[k].at + at] = 1;
    for (std::size_t s = 0, at = in_b[to_b[next]].at; s + 1 < q.size(); ++s, at = (at + 1) % lb.size())
      filled_b[to_b[next] - in_b[to_b[next]].at + at] = 1;
    std::reverse(q.begin(), q.end());
    zipper_lines(mesh, p, q, like);
    ++pieces.strips, pieces.length += mesh::loop_length(mesh, {p, false});
    starts[k] = 1, ends[next] = 1;
  }
  const auto leave_open = [&](const std::vector<Place>& all, const std::vector<mesh::Loop>& loops,
                              const std::vector<char>& filled) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      const mesh::Loop& l = loops[all[k].loop];
      if (filled[k] || (!l.closed && all[k].at + 1 == l.size())) continue;
      open.push_back({l.vertices[all[k].at], l.vertices[(all[k].at + 1) % l.size()]});
    }
  };
  leave_open(in_a, a, filled_a), leave_open(in_b, b, filled_b);
  for (std::size_t k = 0; k < in_a.size(); ++k) {
    if (starts[k] == ends[k]) continue;
    const int va = a[in_a[k].loop].vertices[in_a[k].at], vb = b[in_b[to_b[k]].loop].vertices[in_b[to_b[k]].at];
    open.push_back(starts[k] ? std::array<int, 2>{va, vb} : std::array<int, 2>{vb, va});
  }
  pieces.open = mesh::trace_loops(open);
  return pieces;
}

void cap(Mesh& mesh, const mesh::Loop& loop, const std::vector<int>& like) {
  std::vector<int> ring = loop.vertices;
  // The area vector's direction says which ears are convex.
  Vec3 up = Vec3::Zero();
  for (std::size_t k = 0; k < ring.size(); ++k)
    up += (mesh.vertices[ring[k]] - mesh.vertices[ring[0]])
              .cross(mesh.vertices[ring[(k + 1) % ring.size()]] - mesh.vertices[ring[0]]);
  up.normalize();
  while (ring.size() > 3) {
    const int n = int(ring.size());
    int ear = 0;
    double best = -1e300;
    for (int k = 0; k < n; ++k) {
      const Vec3 &u = mesh.vertices[ring[(k + n - 1) % n]], &v = mesh.vertices[ring[k]],
                 &w = mesh.vertices[ring[(k + 1) % n]];
      const Vec3 e = u - v, f = w - v;
      const double lengths = e.norm() * f.norm();
      const double turn = lengths > 0 ? f.cross(e).dot(up) / lengths : 0;
      // Convex and sharp first: the chord that replaces the corner is short.
      const double score = (turn >= 0 ? 1 : -1) - (u - w).norm() / (e.norm() + f.norm() + 1e-300);
      if (score > best) best = score, ear = k;
    }
    const int u = ring[(ear + n - 1) % n], v = ring[ear], w = ring[(ear + 1) % n];
    mesh::add_face_like(mesh, like[v], {w, v, u});
    ring.erase(ring.begin() + ear);
  }
  if (ring.size() == 3) mesh::add_face_like(mesh, like[ring[0]], {ring[2], ring[1], ring[0]});
}

}  // namespace parts::seam
