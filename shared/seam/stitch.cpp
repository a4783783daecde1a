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

void zipper(Mesh& mesh, const mesh::Loop& a, const mesh::Loop& b, const std::vector<int>& like) {
  mesh::Loop back = b;
  std::reverse(back.vertices.begin(), back.vertices.end());
  const auto [i, j] = nearest_pair(mesh, a.vertices, back.vertices);
  zipper_lines(mesh, unrolled(a, i), unrolled(back, j), like);
}

}  // namespace parts::seam
