// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/mesh_formats.h"

#include <cmath>
#include <limits>

namespace parts::io::formats {

double Scanner::to_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range)
    return word.find("e-") == word.npos && word.find("E-") == word.npos ? std::numeric_limits<double>::infinity() : 0;
  if (error == std::errc() && end == word.data() + word.size()) return value;
  if (word.find("#IN") != word.npos || word.find("#QNAN") != word.npos || word.find("nan") != word.npos)
    return std::numeric_limits<double>::quiet_NaN();  // as some C libraries print it
  if (word.empty()) throw Malformed("ends in the middle of the data");
  throw Malformed("has \"" + std::string(word.substr(0, 20)) + "\" where a number should be");
}

std::uint64_t check_head(const std::string& format, std::string_view head, std::uint64_t size) {
  if (size == 0) throw Malformed("is empty");
  if (format == ".ply") {
    if (Scanner(head).line() != "ply") throw Malformed("does not begin with \"ply\"");
  } else if (format == ".stl") {
    return stl_size(head, size);
  } else if (head.find('\0') != head.npos) {
    throw Malformed("is not text, as a file of that ending is");
  }
  return size;
}

long Scanner::to_integer(std::string_view word) {
  const double value = to_number(word);
  if (!(std::abs(value) < 1e15) || value != std::floor(value))
    throw Malformed("has \"" + std::string(word.substr(0, 20)) + "\" where a whole number should be");
  return long(value);
}

namespace {

using Vec2 = Eigen::Vector2d;

/// The polygon seen along its normal, counter-clockwise; empty if it is flat.
std::vector<Vec2> seen_from_above(const std::vector<Vec3>& vertices, const std::vector<int>& polygon) {
  Vec3 normal = Vec3::Zero();  // Newell's
  const Vec3& origin = vertices[polygon[0]];
  for (std::size_t i = 0; i < polygon.size(); ++i)
    normal += (vertices[polygon[i]] - origin).cross(vertices[polygon[(i + 1) % polygon.size()]] - origin);
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  if (!(std::abs(normal[axis]) > 0) || !std::isfinite(normal[axis])) return {};
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  std::vector<Vec2> points;
  for (int v : polygon) {
    const Vec3 p = vertices[v] - origin;
    points.push_back(normal[axis] > 0 ? Vec2(p[x], p[y]) : Vec2(p[y], p[x]));
  }
  return points;
}

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

constexpr int kEar = -1, kReflex = -2, kUnknown = -3;

/// kEar where the corner b between a and c can be cut off, kReflex where it does
/// not stick out, else a point that lies in its way.
int what_blocks(const std::vector<Vec2>& points, const std::vector<int>& left, int a, int b, int c) {
  if (!(turn(points[a], points[b], points[c]) > 0)) return kReflex;
  for (int i : left)
    if (i != a && i != b && i != c && turn(points[a], points[b], points[i]) >= 0 &&
        turn(points[b], points[c], points[i]) >= 0 && turn(points[c], points[a], points[i]) >= 0)
      return i;
  return kEar;
}

/// Cuts ears off a polygon as long as there are some. A corner is looked at anew
/// only once a corner beside it, or the point in its way, is gone.
void cut_ears(const std::vector<Vec2>& points, std::vector<int>& left, std::vector<Triangle>& triangles) {
  std::vector<int> block(points.size(), kUnknown);
  std::vector<char> gone(points.size(), 0);
  for (int i = 0, tried = 0; left.size() > 3 && tried < int(left.size());) {
    const int m = int(left.size()), a = left[i % m], b = left[(i + 1) % m], c = left[(i + 2) % m];
    if (block[b] == kUnknown || (block[b] >= 0 && gone[block[b]])) block[b] = what_blocks(points, left, a, b, c);
    if (block[b] == kEar) {
      triangles.push_back({a, b, c});
      left.erase(left.begin() + (i + 1) % m);
      gone[b] = 1;
      block[a] = block[c] = kUnknown;
      tried = 0;
    } else {
      ++tried;
    }
    i = (i + 1) % int(left.size());
  }
}

}  // namespace

std::vector<Triangle> triangulate(const std::vector<Vec3>& vertices, const std::vector<int>& polygon) {
  constexpr int kTooManyForEars = 1000;  // their cost is quadratic
  const int n = int(polygon.size());
  std::vector<Triangle> triangles;
  std::vector<Vec2> points;
  if (n > 3 && n <= kTooManyForEars) points = seen_from_above(vertices, polygon);
  std::vector<int> left(n);
  for (int i = 0; i < n; ++i) left[i] = i;
  if (n == 4 && !points.empty()) {  // the shorter diagonal, where both lie inside
    const bool even = turn(points[0], points[1], points[2]) > 0 && turn(points[0], points[2], points[3]) > 0;
    const bool odd = turn(points[0], points[1], points[3]) > 0 && turn(points[1], points[2], points[3]) > 0;
    const auto length = [&](int i, int j) { return (vertices[polygon[i]] - vertices[polygon[j]]).norm(); };
    if (odd && (!even || length(1, 3) < length(0, 2))) return {{0, 1, 3}, {1, 2, 3}};
  }
  if (!points.empty()) cut_ears(points, left, triangles);
  for (std::size_t i = 1; i + 1 < left.size(); ++i) triangles.push_back({left[0], left[i], left[i + 1]});
  return triangles;
}

bool fits_floats(const Mesh& mesh) {
  for (const Vec3& p : mesh.vertices)
    for (double x : p)
      if (std::isfinite(x) && double(float(x)) != x) return false;
  return true;
}

void append_point(std::string& text, const Vec3& p, bool floats) {
  for (int k = 0; k < 3; ++k) {
    if (k) text += ' ';
    if (floats)
      append(text, float(p[k]));
    else
      append(text, p[k]);
  }
}

}  // namespace parts::io::formats
