// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "parts/io/mesh_formats.h"

namespace parts::io::formats {
namespace {

constexpr Color kWhite{255, 255, 255, 255};

struct Material {
  Color color = kWhite;
  int texture = -1;
};

std::uint8_t to_byte(double share) {
  return std::uint8_t(std::lround(std::clamp(share >= 0 ? share : 0, 0., 1.) * 255));
}

std::string lower(std::string_view word) {
  std::string out(word);
  for (char& c : out) c = char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

bool is_number(std::string_view word) {
  try {
    Scanner::to_number(word);
    return true;
  } catch (const Malformed&) {
    return false;
  }
}

/// Without blanks at its ends.
std::string trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t"), to = text.find_last_not_of(" \t");
  return from == text.npos ? "" : std::string(text.substr(from, to - from + 1));
}

/// The rest of a line.
std::string rest_of(Scanner& words) { return trimmed(words.line()); }

/// How many words an option of a texture map may have behind it: so many at
/// least, so many at most, of which the further ones are numbers. (The MTL
/// specification, appendix B1 of Wavefront's Advanced Visualizer manual.)
std::pair<int, int> words_of_option(const std::string& option) {
  if (option == "-o" || option == "-s" || option == "-t") return {1, 3};
  if (option == "-mm") return {2, 2};
  for (const char* with_one : {"-blendu", "-blendv", "-boost", "-bm", "-cc", "-clamp", "-imfchan", "-texres", "-type"})
    if (option == with_one) return {1, 1};
  return {-1, -1};
}

/// The file of a map_Kd line: behind its options, with blanks in it, perhaps in quotes.
std::string texture_file(std::string_view line) {
  std::string rest = trimmed(line);
  while (!rest.empty() && rest[0] == '-') {
    Scanner words(rest);
    const auto [least, most] = words_of_option(lower(words.word()));
    if (least < 0) break;  // a name that begins so
    Scanner behind = words;
    for (int k = 0; k < most; ++k) {
      const std::string_view word = words.word();
      if (word.empty() || (k >= least && !is_number(word))) break;
      behind = words;
    }
    rest = trimmed(behind.line());
  }
  if (rest.size() > 1 && (rest.front() == '"' || rest.front() == '\'') && rest.back() == rest.front())
    rest = rest.substr(1, rest.size() - 2);
  return rest;
}

/// @throws Malformed
void read_materials(std::string_view text, std::map<std::string, Material>& materials,
                    std::vector<std::string>& textures) {
  Material* current = nullptr;
  for (Scanner file(text); !file.done();) {
    Scanner words(file.line());
    const std::string key = lower(words.word());
    if (key == "newmtl") {
      current = &materials[rest_of(words)];
    } else if (key == "kd" && current) {
      for (int k = 0; k < 3; ++k) current->color[k] = to_byte(words.number());
    } else if (key == "map_kd" && current) {
      const std::string name = texture_file(words.line());
      if (name.empty()) continue;
      const auto known = std::find(textures.begin(), textures.end(), name);
      current->texture = int(known - textures.begin());
      if (known == textures.end()) textures.push_back(name);
    }
  }
}

struct Corner {
  int vertex = -1, uv = -1, normal = -1;
};

/// Counts from the end where negative, from one where positive.
int resolve(std::string_view word, std::size_t so_far) {
  const long i = Scanner::to_integer(word);
  const long index = i > 0 ? i - 1 : i < 0 ? long(so_far) + i : -1;
  if (index < 0 || index > 0x7fffffff) throw Malformed("has a face with a corner that does not exist");
  return int(index);
}

/// An .obj as it comes: its faces may name what follows later.
class ObjFile {
 public:
  ObjFile(const Sibling& library, std::vector<std::string>& missing) : library_(library), missing_(missing) {}
  void read(std::string_view bytes, Pace& pace);
  Mesh mesh(Pace& pace);

 private:
  void read_line(std::string_view line);
  void read_vertex(Scanner& words);
  void read_face(Scanner& words);
  void add_polygon(std::size_t face, Mesh& mesh) const;
  void use_library(const std::string& names);

  const Sibling& library_;
  std::vector<std::string>& missing_;
  std::vector<Vec3> vertices_;
  std::vector<Color> colors_;
  std::vector<Eigen::Vector2f> uvs_;
  std::vector<Eigen::Vector3f> normals_;
  std::vector<Corner> corners_;
  std::vector<std::size_t> first_corner_{0};  // of each polygon, and the end
  std::vector<const Material*> material_;     // of each polygon
  const Material* current_ = nullptr;
  std::map<std::string, Material> materials_;
  std::vector<std::string> textures_;
};

void ObjFile::use_library(const std::string& names) {
  // One name with blanks, or several names.
  if (const auto text = library_(names)) return read_materials(*text, materials_, textures_);
  std::vector<std::string> lost;
  bool found = false;
  Scanner words(names);
  for (std::string name(words.word()); !name.empty(); name = words.word()) {
    const auto text = library_(name);
    if (text) read_materials(*text, materials_, textures_);
    if (!text) lost.push_back(name);
    found |= bool(text);
  }
  if (found)
    missing_.insert(missing_.end(), lost.begin(), lost.end());
  else
    missing_.push_back(names);
}

void ObjFile::read_vertex(Scanner& words) {
  Vec3 p;
  for (double& x : p) x = words.number();
  vertices_.push_back(p);
  double more[4];
  int n = 0;
  for (std::string_view w = words.word(); n < 4 && !w.empty(); w = words.word()) more[n++] = Scanner::to_number(w);
  if (n < 3) return;  // nothing, or the weight of a rational curve
  colors_.resize(vertices_.size(), kWhite);
  const double scale = more[0] <= 1 && more[1] <= 1 && more[2] <= 1 ? 1 : 1. / 255;
  for (int k = 0; k < n; ++k) colors_.back()[k] = to_byte(more[k] * scale);
}

void ObjFile::read_face(Scanner& words) {
  for (std::string_view word = words.word(); !word.empty() && word[0] != '#'; word = words.word()) {
    Corner c;
    const std::size_t a = std::min(word.find('/'), word.size()), b = std::min(word.find('/', a + 1), word.size());
    c.vertex = resolve(word.substr(0, a), vertices_.size());
    if (b > a + 1) c.uv = resolve(word.substr(a + 1, b - a - 1), uvs_.size());
    if (word.size() > b + 1) c.normal = resolve(word.substr(b + 1), normals_.size());
    corners_.push_back(c);
  }
  first_corner_.push_back(corners_.size());
  material_.push_back(current_);
}

void ObjFile::read_line(std::string_view line) {
  Scanner words(line);
  const std::string_view key = words.word();
  if (key == "v") {
    read_vertex(words);
  } else if (key == "vt") {
    const float u = float(words.number());
    const std::string_view v = words.word();
    uvs_.emplace_back(u, v.empty() ? 0 : float(Scanner::to_number(v)));
  } else if (key == "vn") {
    Eigen::Vector3f n;
    for (float& x : n) x = float(words.number());
    normals_.push_back(n);
  } else if (key == "f") {
    read_face(words);
  } else if (key == "usemtl") {
    const auto found = materials_.find(rest_of(words));
    current_ = found == materials_.end() ? nullptr : &found->second;
  } else if (key == "mtllib") {
    use_library(rest_of(words));
  }
}

void ObjFile::read(std::string_view bytes, Pace& pace) {
  std::string joined;
  for (Scanner file(bytes); !file.done(); pace.step()) {
    std::string_view line = file.line();
    if (!line.empty() && line.back() == '\\') {  // goes on in the next line
      joined = line;
      while (!joined.empty() && joined.back() == '\\') {
        joined.back() = ' ';
        joined += file.line();
      }
      line = joined;
    }
    read_line(line);
  }
}

void ObjFile::add_polygon(std::size_t face, Mesh& mesh) const {
  const Corner* corner = &corners_[first_corner_[face]];
  std::vector<int> polygon(first_corner_[face + 1] - first_corner_[face]);
  bool has_uv = true;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    if (corner[k].vertex >= int(vertices_.size()) || corner[k].uv >= int(uvs_.size()) ||
        corner[k].normal >= int(normals_.size()))
      throw Malformed("has a face with a corner that does not exist");
    polygon[k] = corner[k].vertex;
    has_uv &= corner[k].uv >= 0;
    if (corner[k].normal >= 0) mesh.vertex_normal[polygon[k]] += normals_[corner[k].normal];
  }
  const Material* material = material_[face];
  for (const Triangle& t : triangulate(vertices_, polygon)) {
    mesh.faces.push_back({polygon[t[0]], polygon[t[1]], polygon[t[2]]});
    mesh.face_color.push_back(material && material->texture < 0 ? material->color : kWhite);
    Wedges w;
    for (int k = 0; k < 3 && has_uv; ++k) w.uv[k] = uvs_[corner[t[k]].uv];
    w.texture = has_uv && material ? material->texture : -1;
    mesh.wedges.push_back(w);
  }
}

Mesh ObjFile::mesh(Pace& pace) {
  Mesh mesh;
  if (!normals_.empty()) mesh.vertex_normal.assign(vertices_.size(), Eigen::Vector3f::Zero());
  for (std::size_t f = 0; f < material_.size(); ++f, pace.step())
    if (first_corner_[f + 1] - first_corner_[f] >= 3) add_polygon(f, mesh);
  for (Eigen::Vector3f& n : mesh.vertex_normal)
    if (n.squaredNorm() > 0) n.normalize();
  // Materials colour the faces only where some material without a texture says so.
  const bool colored = std::any_of(material_.begin(), material_.end(),
                                   [](const Material* m) { return m && m->texture < 0 && m->color != kWhite; });
  if (!colored) mesh.face_color.clear();
  if (uvs_.empty()) mesh.wedges.clear();
  if (!colors_.empty()) colors_.resize(vertices_.size(), kWhite);
  mesh.vertices = std::move(vertices_);
  mesh.vertex_color = std::move(colors_);
  mesh.textures = std::move(textures_);
  return mesh;
}

}  // namespace

Mesh parse_obj(std::string_view bytes, const Sibling& material_library, std::vector<std::string>& missing,
               const Poll& poll) {
  Pace pace(poll);
  ObjFile file(material_library, missing);
  file.read(bytes, pace);
  return file.mesh(pace);
}

namespace {

/// A colour as a share, a little above so that readers that cut off the rest
/// get the same byte back.
void append_share(std::string& text, std::uint8_t byte) {
  append(text, byte == 255 ? 1.f : std::round((float(byte) + 0.1f) / 255 * 1e5f) / 1e5f);
}

/// The materials that faces use, each a colour and a texture, and their text.
class MaterialList {
 public:
  explicit MaterialList(const Mesh& mesh) : mesh_(mesh) {}
  int of(int face) {
    const int texture = mesh_.wedges.empty() ? -1 : mesh_.wedges[face].texture;
    const Color color = mesh_.face_color.empty() ? kWhite : mesh_.face_color[face];
    const auto [it, added] = ids_.try_emplace({texture, color}, int(ids_.size()));
    if (added) describe(it->second, color, texture);
    return it->second;
  }
  const std::string& text() const { return text_; }

 private:
  void describe(int id, const Color& color, int texture) {
    text_ += "newmtl material_" + std::to_string(id) + "\nKd";
    for (int k = 0; k < 3; ++k) text_ += ' ', append_share(text_, color[k]);
    text_ += '\n';
    if (texture >= 0) text_ += "map_Kd " + mesh_.textures[texture] + "\n";
  }
  const Mesh& mesh_;
  std::map<std::pair<int, Color>, int> ids_;
  std::string text_;
};

void append_face(std::string& text, const Mesh& mesh, int face) {
  text += 'f';
  for (int k = 0; k < 3; ++k) {
    text += ' ';
    append(text, mesh.faces[face][k] + 1);
    if (!mesh.wedges.empty()) text += '/', append(text, 3 * face + k + 1);
    if (!mesh.vertex_normal.empty()) {
      text += mesh.wedges.empty() ? "//" : "/";
      append(text, mesh.faces[face][k] + 1);
    }
  }
  text += '\n';
}

}  // namespace

ObjText format_obj(const Mesh& mesh, const std::string& material_file) {
  ObjText out;
  std::string& text = out.obj;
  const bool materials = !mesh.textures.empty() || !mesh.face_color.empty();
  const bool floats = fits_floats(mesh);
  if (materials) text += "mtllib " + material_file + "\n";
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    text += "v ";
    append_point(text, mesh.vertices[v], floats);
    if (!mesh.vertex_color.empty())
      for (int k = 0; k < 3; ++k) text += ' ', append_share(text, mesh.vertex_color[v][k]);
    text += '\n';
  }
  for (const Eigen::Vector3f& n : mesh.vertex_normal) {
    text += "vn ";
    append_point(text, n.cast<double>(), true);
    text += '\n';
  }
  for (const Wedges& w : mesh.wedges)
    for (const Eigen::Vector2f& uv : w.uv) {
      text += "vt ";
      append(text, uv.x());
      text += ' ';
      append(text, uv.y());
      text += '\n';
    }
  MaterialList list(mesh);
  for (int f = 0, current = -1; f < mesh.face_count(); ++f) {
    if (materials && list.of(f) != current) {
      current = list.of(f);
      text += "usemtl material_" + std::to_string(current) + "\n";
    }
    append_face(text, mesh, f);
  }
  out.materials = list.text();
  return out;
}

}  // namespace parts::io::formats
