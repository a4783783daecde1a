// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <charconv>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "parts/base/files.h"
#include "parts/mesh/mesh.h"

/// The bytes of mesh files, to and from meshes; read_mesh() and write_mesh()
/// are the way in, and say why these parsers are our own. They trust nothing:
/// every index, count and size is checked against what the file holds.
namespace parts::io::formats {

/// The bytes are not a mesh of that format; what() completes "The file … ".
struct Malformed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The text of a file that a mesh file names, or nothing.
using Sibling = std::function<std::optional<std::string>(const std::string& name)>;

/// Looks at the first bytes of a file of a format (".ply"), before all are read.
/// @return how many of its `size` bytes are worth reading
/// @throws Malformed  it cannot be one
std::uint64_t check_head(const std::string& format, std::string_view head, std::uint64_t size);
constexpr std::size_t kHeadBytes = 1000;
std::uint64_t stl_size(std::string_view head, std::uint64_t size);  ///< the same, of an .stl

/// @throws Malformed, and what poll throws
Mesh parse_ply(std::string_view bytes, const Poll& poll = {});
/// @param missing  gets the names of material libraries that are not there
Mesh parse_obj(std::string_view bytes, const Sibling& material_library, std::vector<std::string>& missing,
               const Poll& poll = {});
Mesh parse_off(std::string_view bytes, const Poll& poll = {});
Mesh parse_stl(std::string_view bytes, const Poll& poll = {});

std::string format_ply(const Mesh& mesh);
std::string format_off(const Mesh& mesh);
struct ObjText {
  std::string obj, materials;  ///< materials is empty when there are none
};
ObjText format_obj(const Mesh& mesh, const std::string& material_file);

/// Cuts a polygon (vertex indices in order) into triangles of positions in
/// `polygon`; concave ones by their ears, crossed or flat ones as a fan.
std::vector<Triangle> triangulate(const std::vector<Vec3>& vertices, const std::vector<int>& polygon);

/// Asks a poll every few thousand items.
class Pace {
 public:
  explicit Pace(const Poll& poll) : poll_(poll) {}
  void step() {
    if (++steps_ % 8192 == 0 && poll_) poll_();
  }

 private:
  const Poll& poll_;
  unsigned steps_ = 0;
};

/// Walks text by numbers and words, whatever the line ends and the locale.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {
    if (text.substr(0, 3) == "\xEF\xBB\xBF") at_ += 3;  // the mark that some editors put before UTF-8
  }
  bool done() const { return at_ == end_; }
  std::size_t left() const { return std::size_t(end_ - at_); }
  /// The rest of the line without its end; moves to the next one.
  std::string_view line() {
    const char* from = at_;
    while (at_ != end_ && *at_ != '\n' && *at_ != '\r') ++at_;
    const std::string_view found(from, std::size_t(at_ - from));
    if (at_ != end_ && *at_ == '\r') ++at_;
    if (at_ != end_ && *at_ == '\n' && (at_ == from + found.size() || at_[-1] == '\r')) ++at_;
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
