// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <charconv>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "parts/mesh/mesh.h"

/// The bytes of mesh files, to and from meshes; read_mesh() and write_mesh()
/// are the way in. The parsers trust nothing: every index, count and size is
/// checked against what the file holds. (vcglib's importers were tried first:
/// they write out of bounds, loop or assert on thirteen of the two dozen broken
/// files of the tests, and find an .obj's materials only by changing the
/// directory of the whole process; its .obj exporter keeps six decimals.)
namespace parts::io::formats {

/// The bytes are not a mesh of that format; what() completes "The file … ".
struct Malformed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The text of a file that a mesh file names, or nothing.
using Sibling = std::function<std::optional<std::string>(const std::string& name)>;

/// @throws Malformed
Mesh parse_ply(std::string_view bytes);
Mesh parse_obj(std::string_view bytes, const Sibling& material_library);
Mesh parse_off(std::string_view bytes);
Mesh parse_stl(std::string_view bytes);

std::string format_ply(const Mesh& mesh);
std::string format_off(const Mesh& mesh);
struct ObjText {
  std::string obj, materials;  ///< materials is empty when there are none
};
ObjText format_obj(const Mesh& mesh, const std::string& material_file);

/// Cuts a polygon (vertex indices in order) into triangles of positions in `polygon`.
std::vector<Triangle> triangulate(const std::vector<Vec3>& vertices, const std::vector<int>& polygon);

/// Walks text by numbers and words, whatever the line ends and the locale.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}
  bool done() const { return at_ == end_; }
  std::size_t left() const { return std::size_t(end_ - at_); }
  /// The rest of the line without its end; moves to the next one.
  std::string_view line() {
    const char* from = at_;
    while (at_ != end_ && *at_ != '\n') ++at_;
    std::string_view found(from, std::size_t(at_ - from));
    if (at_ != end_) ++at_;
    if (!found.empty() && found.back() == '\r') found.remove_suffix(1);
    return found;
  }
  /// The next word, of this or a later line; empty at the end.
  std::string_view word() {
    while (at_ != end_ && blank(*at_)) ++at_;
    const char* from = at_;
    while (at_ != end_ && !blank(*at_)) ++at_;
    return {from, std::size_t(at_ - from)};
  }
  /// @throws Malformed  the next word is not a number
  double number() { return to_number(word()); }
  static double to_number(std::string_view word);
  /// @throws Malformed  also when it is not whole
  static long to_integer(std::string_view word);

 private:
  static bool blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }
  const char *at_, *end_;
};

/// Appends the shortest text that reads back as the same value.
template <class Number>
void append(std::string& text, Number value) {
  char buffer[32];
  text.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

/// Whether every coordinate is a float's value, so that floats can hold it.
bool fits_floats(const Mesh& mesh);
/// Appends x, y, z with blanks between, as floats where they fit.
void append_point(std::string& text, const Vec3& p, bool floats);

}  // namespace parts::io::formats
