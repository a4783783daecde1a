// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/attributes.h"

#include <algorithm>

namespace parts::mesh {
namespace {

constexpr Color kWhite{255, 255, 255, 255};

Color mix(const Color& a, const Color& b, double t) {
  Color c;
  for (int k = 0; k < 4; ++k) c[k] = std::uint8_t(a[k] + t * (b[k] - a[k]) + 0.5);
  return c;
}

template <class T>
void append_array(std::vector<T>& to, std::size_t to_count, const std::vector<T>& from, std::size_t from_count,
                  const T& neutral) {
  if (to.empty() && from.empty()) return;
  to.resize(to_count, neutral);
  if (from.empty())
    to.resize(to_count + from_count, neutral);
  else
    to.insert(to.end(), from.begin(), from.end());
}

template <class T>
std::vector<T> taken(const std::vector<T>& array, const std::vector<int>& indices) {
  std::vector<T> out;
  if (array.empty()) return out;
  out.reserve(indices.size());
  for (int i : indices) out.push_back(array[i]);
  return out;
}

}  // namespace

int add_vertex_between(Mesh& m, int i, int j, double t) {
  m.vertices.push_back((1 - t) * m.vertices[i] + t * m.vertices[j]);
  if (!m.vertex_normal.empty()) {
    const float s = float(t);
    m.vertex_normal.push_back(((1 - s) * m.vertex_normal[i] + s * m.vertex_normal[j]).normalized());
  }
  if (!m.vertex_color.empty()) m.vertex_color.push_back(mix(m.vertex_color[i], m.vertex_color[j], t));
  if (!m.vertex_quality.empty())
    m.vertex_quality.push_back(float((1 - t) * m.vertex_quality[i] + t * m.vertex_quality[j]));
  if (!m.vertex_selected.empty()) m.vertex_selected.push_back(m.vertex_selected[i] && m.vertex_selected[j]);
  return m.vertex_count() - 1;
}

int add_vertex_within(Mesh& m, int face, const Vec3& l) {
  const Triangle t = m.faces[face];
  m.vertices.push_back(l[0] * m.vertices[t[0]] + l[1] * m.vertices[t[1]] + l[2] * m.vertices[t[2]]);
  const Eigen::Vector3f w = l.cast<float>();
  if (!m.vertex_normal.empty())
    m.vertex_normal.push_back(
        (w[0] * m.vertex_normal[t[0]] + w[1] * m.vertex_normal[t[1]] + w[2] * m.vertex_normal[t[2]]).normalized());
  if (!m.vertex_color.empty()) {
    Color c;
    for (int k = 0; k < 4; ++k)
      c[k] = std::uint8_t(std::clamp(
          l[0] * m.vertex_color[t[0]][k] + l[1] * m.vertex_color[t[1]][k] + l[2] * m.vertex_color[t[2]][k] + 0.5, 0.0,
          255.0));
    m.vertex_color.push_back(c);
  }
  if (!m.vertex_quality.empty())
    m.vertex_quality.push_back(w[0] * m.vertex_quality[t[0]] + w[1] * m.vertex_quality[t[1]] +
                               w[2] * m.vertex_quality[t[2]]);
  if (!m.vertex_selected.empty())
    m.vertex_selected.push_back(m.vertex_selected[t[0]] && m.vertex_selected[t[1]] && m.vertex_selected[t[2]]);
  return m.vertex_count() - 1;
}

int add_face_within(Mesh& m, int parent, const Triangle& vertices, const std::array<Vec3, 3>& barycentric) {
  m.faces.push_back(vertices);
  if (!m.face_color.empty()) m.face_color.push_back(Color(m.face_color[parent]));
  if (!m.face_quality.empty()) m.face_quality.push_back(float(m.face_quality[parent]));
  if (!m.face_selected.empty()) m.face_selected.push_back(char(m.face_selected[parent]));
  if (!m.wedges.empty()) {
    const Wedges from = m.wedges[parent];
    Wedges w = from;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f b = barycentric[k].cast<float>();
      w.uv[k] = b[0] * from.uv[0] + b[1] * from.uv[1] + b[2] * from.uv[2];
    }
    m.wedges.push_back(w);
  }
  return m.face_count() - 1;
}

int add_face_like(Mesh& m, int like, const Triangle& vertices) {
  std::array<Vec3, 3> corner;
  for (int k = 0; k < 3; ++k) {
    int nearest = 0;
    double best = 1e300;
    for (int c = 0; c < 3; ++c)
      if (const double d = (m.corner(like, c) - m.vertices[vertices[k]]).squaredNorm(); d < best) best = d, nearest = c;
    corner[k] = Vec3::Unit(nearest);
  }
  return add_face_within(m, like, vertices, corner);
}

Mesh take_faces(const Mesh& mesh, const std::vector<char>& flags, std::vector<int>* old_vertex,
                std::vector<int>* old_face) {
  std::vector<int> vertex, face, number(mesh.vertex_count(), -1);
  for (int f = 0; f < mesh.face_count(); ++f)
    if (flags[f]) {
      face.push_back(f);
      for (int v : mesh.faces[f]) number[v] = 0;
    }
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (number[v] == 0) number[v] = int(vertex.size()), vertex.push_back(v);
  Mesh out;
  out.vertices = taken(mesh.vertices, vertex);
  out.vertex_normal = taken(mesh.vertex_normal, vertex);
  out.vertex_color = taken(mesh.vertex_color, vertex);
  out.vertex_quality = taken(mesh.vertex_quality, vertex);
  out.vertex_selected = taken(mesh.vertex_selected, vertex);
  out.faces = taken(mesh.faces, face);
  for (Triangle& f : out.faces)
    for (int& v : f) v = number[v];
  out.face_color = taken(mesh.face_color, face);
  out.face_quality = taken(mesh.face_quality, face);
  out.face_selected = taken(mesh.face_selected, face);
  out.wedges = taken(mesh.wedges, face);
  out.textures = mesh.textures;
  if (old_vertex) *old_vertex = std::move(vertex);
  if (old_face) *old_face = std::move(face);
  return out;
}

void append(Mesh& to, const Mesh& from) {
  const std::size_t nv = to.vertices.size(), mv = from.vertices.size(), nf = to.faces.size(), mf = from.faces.size();
  append_array(to.vertex_normal, nv, from.vertex_normal, mv, Eigen::Vector3f(0, 0, 0));
  append_array(to.vertex_color, nv, from.vertex_color, mv, kWhite);
  append_array(to.vertex_quality, nv, from.vertex_quality, mv, 0.f);
  append_array(to.vertex_selected, nv, from.vertex_selected, mv, char(0));
  append_array(to.face_color, nf, from.face_color, mf, kWhite);
  append_array(to.face_quality, nf, from.face_quality, mf, 0.f);
  append_array(to.face_selected, nf, from.face_selected, mf, char(0));

  std::vector<int> texture;  // from's texture -> to's
  for (const std::string& name : from.textures) {
    const auto it = std::find(to.textures.begin(), to.textures.end(), name);
    texture.push_back(int(it - to.textures.begin()));
    if (it == to.textures.end()) to.textures.push_back(name);
  }
  append_array(to.wedges, nf, from.wedges, mf, Wedges());
  if (!from.wedges.empty())
    for (std::size_t f = nf; f < nf + mf; ++f)
      if (int& t = to.wedges[f].texture; t >= 0) t = t < int(texture.size()) ? texture[t] : -1;

  to.vertices.insert(to.vertices.end(), from.vertices.begin(), from.vertices.end());
  for (Triangle f : from.faces) {
    for (int& v : f) v += int(nv);
    to.faces.push_back(f);
  }
}

void flip_orientation(Mesh& mesh) {
  for (Triangle& f : mesh.faces) std::swap(f[1], f[2]);
  for (Wedges& w : mesh.wedges) std::swap(w.uv[1], w.uv[2]);
  for (Eigen::Vector3f& n : mesh.vertex_normal) n = -n;
}

Mesh transformed(Mesh mesh, const Eigen::Affine3d& map) {
  const Eigen::Matrix3d m = map.linear();
  Eigen::Matrix3d cofactors;  // they transform area vectors, also where the map has no inverse
  for (int c = 0; c < 3; ++c) cofactors.col(c) = m.col((c + 1) % 3).cross(m.col((c + 2) % 3));
  for (Vec3& v : mesh.vertices) v = map * v;
  for (Eigen::Vector3f& n : mesh.vertex_normal) n = (cofactors * n.cast<double>()).stableNormalized().cast<float>();
  if (m.determinant() < 0) flip_orientation(mesh);
  return mesh;
}

void update_normals(Mesh& mesh) {
  std::vector<Vec3> sum(mesh.vertices.size(), Vec3::Zero());
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 n = (mesh.corner(f, 1) - mesh.corner(f, 0)).cross(mesh.corner(f, 2) - mesh.corner(f, 0));
    for (int v : mesh.faces[f]) sum[v] += n;
  }
  mesh.vertex_normal.resize(sum.size());
  for (std::size_t v = 0; v < sum.size(); ++v) mesh.vertex_normal[v] = sum[v].normalized().cast<float>();
}

}  // namespace parts::mesh
