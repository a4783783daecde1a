// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "parts/io/mesh_formats.h"
#include "parts/mesh/arrays.h"

namespace parts::io::formats {
namespace {

/// What the letters before OFF announce: [ST][C][N][4][n]OFF.
struct OffKind {
  bool uv = false, color = false, normal = false, homogeneous = false;
};

OffKind kind_of(std::string_view word) {
  OffKind kind;
  if (word.size() < 3 || word.substr(word.size() - 3) != "OFF") throw Malformed("does not begin with \"OFF\"");
  word.remove_suffix(3);
  const auto take = [&](std::string_view letters) {
    const bool found = word.substr(0, letters.size()) == letters;
    if (found) word.remove_prefix(letters.size());
    return found;
  };
  kind.uv = take("ST");
  kind.color = take("C");
  kind.normal = take("N");
  kind.homogeneous = take("4");
  if (!word.empty()) throw Malformed("has the unknown kind \"" + std::string(word.substr(0, 20)) + "OFF\"");
  return kind;
}

/// The file's words line by line, without comments and empty lines.
class Lines {
 public:
  explicit Lines(std::string_view bytes) : file_(bytes) {}
  /// Moves to the next line that holds something. @throws Malformed at the end
  void next() {
    do {
      if (file_.done()) throw Malformed("ends in the middle of the data");
      words_ = Scanner(without_comment(file_.line()));
      word_ = words_.word();
    } while (word_.empty());
  }
  bool more() const { return !word_.empty(); }  ///< in this line
  std::string_view take() {
    if (word_.empty()) next();
    const std::string_view taken = word_;
    word_ = words_.word();
    return taken;
  }
  double number() { return Scanner::to_number(take()); }
  long integer() { return Scanner::to_integer(take()); }
  std::vector<std::string_view> rest() {
    std::vector<std::string_view> words;
    while (more()) words.push_back(take());
    return words;
  }
  std::size_t left() const { return file_.left(); }

 private:
  static std::string_view without_comment(std::string_view line) { return line.substr(0, line.find('#')); }
  Scanner file_, words_{""};
  std::string_view word_;
};

/// Three or four numbers, bytes if whole and shares if not. One number is an
/// entry of a colour map that nobody ships: no colour.
bool read_color(const std::vector<std::string_view>& words, std::size_t n, Color& color) {
  if (n < 3) return false;
  const bool shares = words[0].find('.') != words[0].npos;
  color = {255, 255, 255, 255};
  for (std::size_t k = 0; k < std::min<std::size_t>(n, 4); ++k) {
    const double c = Scanner::to_number(words[k]) * (shares ? 255 : 1);
    color[k] = std::uint8_t(std::lround(std::clamp(c >= 0 ? c : 0, 0., 255.)));
  }
  return true;
}

void read_vertex(Lines& file, const OffKind& kind, Mesh& mesh, std::vector<Eigen::Vector2f>& uv) {
  Vec3 p;
  for (double& x : p) x = file.number();
  if (kind.homogeneous) p /= file.number();
  mesh.vertices.push_back(p);
  if (kind.normal) {
    Eigen::Vector3f n;
    for (float& x : n) x = float(file.number());
    mesh.vertex_normal.push_back(n);
  }
  if (!kind.color && !kind.uv) return;
  const std::vector<std::string_view> rest = file.rest();  // colours are told by the end of the line
  const std::size_t n_uv = kind.uv ? 2 : 0;
  if (rest.size() < n_uv) throw Malformed("has a vertex without texture coordinates");
  Color c{255, 255, 255, 255};
  if (kind.color) read_color(rest, rest.size() - n_uv, c), mesh.vertex_color.push_back(c);
  if (kind.uv)
    uv.emplace_back(float(Scanner::to_number(rest[rest.size() - 2])), float(Scanner::to_number(rest[rest.size() - 1])));
}

void read_face(Lines& file, Mesh& mesh) {
  file.next();
  const long n = file.integer();
  if (n < 0 || n > long(mesh.vertices.size()) + long(file.left())) throw Malformed("has a face of impossible size");
  std::vector<int> polygon;
  for (long k = 0; k < n; ++k) {
    const long v = file.integer();
    if (v < 0 || v >= mesh.vertex_count()) throw Malformed("has a face with a vertex that does not exist");
    polygon.push_back(int(v));
  }
  Color c;
  const std::vector<std::string_view> rest = file.rest();
  const bool colored = read_color(rest, rest.size(), c);
  if (n < 3) return;
  for (const Triangle& t : triangulate(mesh.vertices, polygon)) {
    if (colored) mesh.face_color.resize(mesh.faces.size(), {255, 255, 255, 255}), mesh.face_color.push_back(c);
    mesh.faces.push_back({polygon[t[0]], polygon[t[1]], polygon[t[2]]});
  }
}

}  // namespace

Mesh parse_off(std::string_view bytes, const Poll& poll) {
  Pace pace(poll);
  Lines file(bytes);
  file.next();
  const OffKind kind = kind_of(file.take());
  const long vertices = file.integer(), faces = file.integer();
  file.rest();  // the number of edges, which nobody fills in
  // A vertex takes at least "0 0 0", a face at least "0", and a line's end.
  if (vertices < 0 || faces < 0 || vertices > 0x7fffffff || 6 * vertices + 2 * faces > long(file.left()) + 1)
    throw Malformed("is shorter than its header says");
  Mesh mesh;
  mesh.vertices.reserve(std::size_t(vertices));
  std::vector<Eigen::Vector2f> uv;
  for (long v = 0; v < vertices; ++v, pace.step()) read_vertex(file, kind, mesh, uv);
  if (file.more()) throw Malformed("has more numbers than its vertices need");
  for (long f = 0; f < faces; ++f, pace.step()) read_face(file, mesh);
  mesh::fill_face_attributes(mesh);
  for (std::size_t f = 0; f < mesh.faces.size() && !uv.empty(); ++f) {
    const Triangle& t = mesh.faces[f];
    mesh.wedges.push_back({{uv[t[0]], uv[t[1]], uv[t[2]]}, -1});
  }
  return mesh;
}

std::string format_off(const Mesh& mesh) {
  const bool floats = fits_floats(mesh), color = !mesh.vertex_color.empty(), normal = !mesh.vertex_normal.empty();
  std::string text = std::string(color ? "C" : "") + (normal ? "N" : "") + "OFF\n";
  text += std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.faces.size()) + " 0\n";
  const auto append_color = [&](const Color& c) {
    for (std::uint8_t byte : c) text += ' ', append(text, int(byte));
  };
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    append_point(text, mesh.vertices[v], floats);
    if (normal) text += ' ', append_point(text, mesh.vertex_normal[v].cast<double>(), true);
    if (color) append_color(mesh.vertex_color[v]);
    text += '\n';
  }
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    text += '3';
    for (int v : mesh.faces[f]) text += ' ', append(text, v);
    if (!mesh.face_color.empty()) append_color(mesh.face_color[f]);
    text += '\n';
  }
  return text;
}

}  // namespace parts::io::formats
