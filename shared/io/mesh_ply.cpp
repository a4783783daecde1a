// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstring>

#include "parts/io/mesh_formats.h"
#include "parts/mesh/arrays.h"

namespace parts::io::formats {
namespace {

enum class Type { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };
enum class Encoding { Text, Little, Big };
constexpr int kSelected = 0x20;  // the bit of MeshLab's flags

int size_of(Type t) {
  constexpr int sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[int(t)];
}

Type type_named(std::string_view name) {
  constexpr std::pair<const char*, Type> names[] = {
      {"char", Type::Int8},   {"int8", Type::Int8},     {"uchar", Type::Uint8},   {"uint8", Type::Uint8},
      {"short", Type::Int16}, {"int16", Type::Int16},   {"ushort", Type::Uint16}, {"uint16", Type::Uint16},
      {"int", Type::Int32},   {"int32", Type::Int32},   {"uint", Type::Uint32},   {"uint32", Type::Uint32},
      {"float", Type::Float}, {"float32", Type::Float}, {"double", Type::Double}, {"float64", Type::Double},
  };
  for (const auto& [text, type] : names)
    if (name == text) return type;
  throw Malformed("names an unknown type \"" + std::string(name.substr(0, 20)) + "\" in its header");
}

/// What a property means to us.
enum Slot { X, Y, Z, Nx, Ny, Nz, Red, Green, Blue, Alpha, Quality, U, V, Flags, Texture, Indices, Texcoords, Ignored };

Slot slot_named(std::string_view name) {
  constexpr std::pair<const char*, Slot> names[] = {
      {"x", X},
      {"y", Y},
      {"z", Z},
      {"nx", Nx},
      {"ny", Ny},
      {"nz", Nz},
      {"red", Red},
      {"green", Green},
      {"blue", Blue},
      {"alpha", Alpha},
      {"diffuse_red", Red},
      {"diffuse_green", Green},
      {"diffuse_blue", Blue},
      {"diffuse_alpha", Alpha},
      {"quality", Quality},
      {"scalar", Quality},
      {"confidence", Quality},
      {"u", U},
      {"v", V},
      {"s", U},
      {"t", V},
      {"texture_u", U},
      {"texture_v", V},
      {"texture_s", U},
      {"texture_t", V},
      {"flags", Flags},
      {"texnumber", Texture},
      {"vertex_indices", Indices},
      {"vertex_index", Indices},
      {"texcoord", Texcoords},
  };
  for (const auto& [text, slot] : names)
    if (name == text) return slot;
  return Ignored;
}

struct Property {
  Type type, count_type = Type::Uint8;
  bool list = false;
  Slot slot = Ignored;
};

struct Element {
  std::string name;
  long count = 0;
  std::vector<Property> properties;
  bool has(Slot slot, bool list = false) const {
    return std::any_of(properties.begin(), properties.end(),
                       [&](const Property& p) { return p.slot == slot && p.list == list; });
  }
};

struct Header {
  Encoding encoding = Encoding::Text;
  std::vector<Element> elements;
  std::vector<std::string> textures;
};

void read_property(Scanner& words, Header& header) {
  if (header.elements.empty()) throw Malformed("has a property before the first element in its header");
  Property p{};
  std::string_view type = words.word();
  if (type == "list") {
    p.list = true;
    p.count_type = type_named(words.word());
    type = words.word();
  }
  p.type = type_named(type);
  p.slot = slot_named(words.word());
  if (p.list != (p.slot == Indices || p.slot == Texcoords)) p.slot = Ignored;
  if (p.slot == Quality && header.elements.back().has(Quality)) p.slot = Ignored;
  header.elements.back().properties.push_back(p);
}

Header read_header(Scanner& file) {
  Header header;
  if (file.line() != "ply") throw Malformed("does not begin with \"ply\"");
  bool format = false;
  while (!file.done()) {
    const std::string_view line = file.line();
    Scanner words(line);
    const std::string_view key = words.word();
    if (key == "end_header") {
      if (!format) throw Malformed("does not name its format in the header");
      return header;
    }
    if (key == "format") {
      const std::string_view name = words.word();
      if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian")
        throw Malformed("has the unknown format \"" + std::string(name.substr(0, 20)) + "\"");
      header.encoding = name == "ascii"                 ? Encoding::Text
                        : name.find("big") != name.npos ? Encoding::Big
                                                        : Encoding::Little;
      format = true;
    } else if (key == "element") {
      Element e;
      e.name = words.word();
      e.count = Scanner::to_integer(words.word());
      if (e.count < 0 || e.count > 0x7fffffff) throw Malformed("has an impossible number of elements in its header");
      header.elements.push_back(e);
    } else if (key == "property") {
      read_property(words, header);
    } else if (key == "comment" && words.word() == "TextureFile") {
      std::string name(words.line());
      name.erase(0, name.find_first_not_of(" \t"));
      header.textures.push_back(name);
    }
  }
  throw Malformed("has a header without end");
}

/// The values of the body one after another, whatever their encoding.
class Body {
 public:
  Body(std::string_view bytes, Encoding encoding) : bytes_(bytes), text_(bytes), encoding_(encoding) {}
  std::size_t left() const { return encoding_ == Encoding::Text ? text_.left() : bytes_.size(); }
  double value(Type type) {
    if (encoding_ == Encoding::Text) return text_.number();
    switch (type) {
      case Type::Int8:
        return take<std::int8_t>();
      case Type::Uint8:
        return take<std::uint8_t>();
      case Type::Int16:
        return take<std::int16_t>();
      case Type::Uint16:
        return take<std::uint16_t>();
      case Type::Int32:
        return take<std::int32_t>();
      case Type::Uint32:
        return take<std::uint32_t>();
      case Type::Float:
        return take<float>();
      default:
        return take<double>();
    }
  }
  std::size_t count(Type type) {
    const double n = value(type);
    if (!(n >= 0) || n > double(left()) || n != std::floor(n)) throw Malformed("has a list of impossible length");
    return std::size_t(n);
  }

 private:
  template <class T>
  T take() {
    if (bytes_.size() < sizeof(T)) throw Malformed("ends in the middle of the data");
    char raw[sizeof(T)];
    std::memcpy(raw, bytes_.data(), sizeof(T));
    bytes_.remove_prefix(sizeof(T));
    if (encoding_ == Encoding::Big) std::reverse(raw, raw + sizeof(T));
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }
  std::string_view bytes_;
  Scanner text_;
  Encoding encoding_;
};

/// One element's values by their meaning.
struct Record {
  double scalar[Ignored + 1] = {};
  std::vector<double> indices, texcoords;

  void read(const Element& element, Body& body) {
    for (const Property& p : element.properties) {
      if (!p.list) {
        double value = body.value(p.type);
        if (p.slot >= Red && p.slot <= Alpha && (p.type == Type::Float || p.type == Type::Double)) value *= 255;
        scalar[p.slot] = value;
        continue;
      }
      std::vector<double> ignored;
      std::vector<double>& values = p.slot == Indices ? indices : p.slot == Texcoords ? texcoords : ignored;
      values.resize(body.count(p.count_type));
      for (double& v : values) v = body.value(p.type);
    }
  }
  Color color() const {
    Color c;
    for (int k = 0; k < 4; ++k)
      c[k] = std::uint8_t(std::clamp(std::isnan(scalar[Red + k]) ? 0 : scalar[Red + k], 0., 255.));
    return c;
  }
  bool selected() const {
    const double flags = scalar[Flags];
    return flags >= 0 && flags <= 0x7fffffff && (long(flags) & kSelected);
  }
  int vertex(std::size_t i, const Mesh& mesh) const {
    const double v = indices[i];
    if (!(v >= 0 && v < double(mesh.vertices.size()))) throw Malformed("has a face with a vertex that does not exist");
    return int(v);
  }
};

void expect_room(const Element& e, const Header& header, const Body& body) {
  double bytes = 0;
  for (const Property& p : e.properties)
    bytes += header.encoding == Encoding::Text ? 2 : p.list ? size_of(p.count_type) : size_of(p.type);
  // The last word of a text has no blank behind it.
  if (bytes * double(e.count) > double(body.left()) + 1) throw Malformed("is shorter than its header says");
}

void read_vertices(const Element& e, Body& body, Mesh& mesh, std::vector<Eigen::Vector2f>& uv, Pace& pace) {
  if (!e.has(X) || !e.has(Y) || !e.has(Z)) throw Malformed("has vertices without coordinates");
  if (!mesh.vertices.empty()) throw Malformed("has more than one list of vertices");
  mesh.vertices.reserve(std::size_t(e.count));
  Record r;
  r.scalar[Alpha] = 255;
  for (long i = 0; i < e.count; ++i, pace.step()) {
    r.read(e, body);
    const double* s = r.scalar;
    mesh.vertices.emplace_back(s[X], s[Y], s[Z]);
    if (e.has(Nx)) mesh.vertex_normal.emplace_back(float(s[Nx]), float(s[Ny]), float(s[Nz]));
    if (e.has(Red)) mesh.vertex_color.push_back(r.color());
    if (e.has(Quality)) mesh.vertex_quality.push_back(float(s[Quality]));
    if (e.has(U)) uv.emplace_back(float(s[U]), float(s[V]));
    if (e.has(Flags)) mesh.vertex_selected.push_back(r.selected());
  }
}

/// The face's triangles with everything it carries.
void add_face(const Element& e, const Record& r, const std::vector<int>& polygon, Mesh& mesh) {
  for (const Triangle& t : triangulate(mesh.vertices, polygon)) {
    mesh.faces.push_back({polygon[t[0]], polygon[t[1]], polygon[t[2]]});
    if (e.has(Red)) mesh.face_color.push_back(r.color());
    if (e.has(Quality)) mesh.face_quality.push_back(float(r.scalar[Quality]));
    if (e.has(Flags)) mesh.face_selected.push_back(r.selected());
    if (!e.has(Texcoords, true)) continue;
    Wedges w;
    if (r.texcoords.size() == 2 * polygon.size()) {
      for (int k = 0; k < 3; ++k) w.uv[k] = {float(r.texcoords[2 * t[k]]), float(r.texcoords[2 * t[k] + 1])};
      const double n = r.scalar[Texture];
      w.texture = n >= 0 && n < double(mesh.textures.size()) ? int(n) : -1;
    }
    mesh.wedges.push_back(w);
  }
}

void add_strips(const Record& r, Mesh& mesh) {
  for (std::size_t i = 0, start = 0; i < r.indices.size(); ++i) {
    if (r.indices[i] == -1) {
      start = i + 1;
    } else if (i >= start + 2) {
      Triangle t{r.vertex(i - 2, mesh), r.vertex(i - 1, mesh), r.vertex(i, mesh)};
      if ((i - start) % 2) std::swap(t[0], t[1]);
      mesh.faces.push_back(t);
    }
  }
}

/// A file may have several lists of faces, of which some have an attribute and others do not.
void begin_faces(const Element& e, Mesh& mesh) {
  const std::size_t before = mesh.faces.size();
  if (e.has(Red)) mesh.face_color.resize(before, {255, 255, 255, 255});
  if (e.has(Quality)) mesh.face_quality.resize(before, 0.f);
  if (e.has(Flags)) mesh.face_selected.resize(before, 0);
  if (e.has(Texcoords, true)) mesh.wedges.resize(before);
}

void read_faces(const Element& e, Body& body, Mesh& mesh, bool strips, Pace& pace) {
  Record r;
  r.scalar[Alpha] = 255;
  std::vector<int> polygon;
  if (!strips) begin_faces(e, mesh);
  for (long i = 0; i < e.count; ++i, pace.step()) {
    r.read(e, body);
    if (strips) {
      add_strips(r, mesh);
      continue;
    }
    polygon.resize(r.indices.size());
    for (std::size_t k = 0; k < polygon.size(); ++k) polygon[k] = r.vertex(k, mesh);
    if (polygon.size() >= 3) add_face(e, r, polygon, mesh);
  }
  mesh::fill_face_attributes(mesh);
}

}  // namespace

Mesh parse_ply(std::string_view bytes, const Poll& poll) {
  Pace pace(poll);
  Scanner head(bytes);
  const Header header = read_header(head);
  Body body(bytes.substr(bytes.size() - head.left()), header.encoding);
  Mesh mesh;
  mesh.textures = header.textures;
  std::vector<Eigen::Vector2f> uv;
  for (const Element& e : header.elements) {
    if (e.properties.empty()) continue;
    expect_room(e, header, body);
    if (e.name == "vertex") {
      read_vertices(e, body, mesh, uv, pace);
    } else if ((e.name == "face" || e.name == "tristrips") && e.has(Indices, true)) {
      read_faces(e, body, mesh, e.name == "tristrips", pace);
    } else {
      Record skipped;
      for (long i = 0; i < e.count; ++i, pace.step()) skipped.read(e, body);
    }
  }
  if (mesh.wedges.empty() && !uv.empty())
    for (const Triangle& f : mesh.faces)
      mesh.wedges.push_back({{uv[f[0]], uv[f[1]], uv[f[2]]}, mesh.textures.empty() ? -1 : 0});
  return mesh;
}

namespace {

template <class T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_color(std::string& out, const Color& c) { out.append(reinterpret_cast<const char*>(c.data()), 4); }

const char kColorProperties[] = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";

std::string header_for(const Mesh& mesh, bool floats) {
  std::string h = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& t : mesh.textures) h += "comment TextureFile " + t + "\n";
  const std::string real = floats ? "property float " : "property double ";
  h += "element vertex " + std::to_string(mesh.vertices.size()) + "\n";
  h += real + "x\n" + real + "y\n" + real + "z\n";
  if (!mesh.vertex_normal.empty()) h += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.vertex_selected.empty()) h += "property int flags\n";
  if (!mesh.vertex_color.empty()) h += kColorProperties;
  if (!mesh.vertex_quality.empty()) h += "property float quality\n";
  h += "element face " + std::to_string(mesh.faces.size()) + "\nproperty list uchar int vertex_indices\n";
  if (!mesh.face_selected.empty()) h += "property int flags\n";
  if (!mesh.wedges.empty()) h += "property list uchar float texcoord\nproperty int texnumber\n";
  if (!mesh.face_color.empty()) h += kColorProperties;
  if (!mesh.face_quality.empty()) h += "property float quality\n";
  return h + "end_header\n";
}

}  // namespace

std::string format_ply(const Mesh& mesh) {
  const bool floats = fits_floats(mesh);
  std::string out = header_for(mesh, floats);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (double x : mesh.vertices[v]) floats ? put(out, float(x)) : put(out, x);
    if (!mesh.vertex_normal.empty())
      for (float x : mesh.vertex_normal[v]) put(out, x);
    if (!mesh.vertex_selected.empty()) put(out, std::int32_t(mesh.vertex_selected[v] ? kSelected : 0));
    if (!mesh.vertex_color.empty()) put_color(out, mesh.vertex_color[v]);
    if (!mesh.vertex_quality.empty()) put(out, mesh.vertex_quality[v]);
  }
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    put(out, std::uint8_t(3));
    for (int v : mesh.faces[f]) put(out, std::int32_t(v));
    if (!mesh.face_selected.empty()) put(out, std::int32_t(mesh.face_selected[f] ? kSelected : 0));
    if (!mesh.wedges.empty()) {
      put(out, std::uint8_t(6));
      for (const Eigen::Vector2f& uv : mesh.wedges[f].uv) put(out, uv.x()), put(out, uv.y());
      put(out, std::int32_t(mesh.wedges[f].texture));
    }
    if (!mesh.face_color.empty()) put_color(out, mesh.face_color[f]);
    if (!mesh.face_quality.empty()) put(out, mesh.face_quality[f]);
  }
  return out;
}

}  // namespace parts::io::formats
