// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/mesh_formats.h"

#include <cmath>
#include <limits>

#include "parts/mesh/ears.h"

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

std::vector<Triangle> triangulate(const std::vector<Vec3>& vertices, const std::vector<int>& polygon) {
  std::vector<Vec3> corners;
  for (int v : polygon) corners.push_back(vertices[v]);
  return mesh::cut_ears(corners);
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
