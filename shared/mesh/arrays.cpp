// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/arrays.h"

namespace parts::mesh {
namespace {

template <class T>
bool fits(const std::vector<T>& attribute, std::size_t count) {
  return attribute.empty() || attribute.size() == count;
}

template <class T>
void fill(std::vector<T>& attribute, std::size_t count, const T& neutral) {
  if (!attribute.empty()) attribute.resize(count, neutral);
}

}  // namespace

std::string array_flaw(const Mesh& m) {
  const std::size_t vertices = m.vertices.size(), faces = m.faces.size();
  if (vertices > 0x7fffffff || faces > 0x7fffffff) return "has more vertices or faces than can be counted";
  if (!fits(m.vertex_normal, vertices) || !fits(m.vertex_color, vertices) || !fits(m.vertex_quality, vertices) ||
      !fits(m.vertex_selected, vertices))
    return "has an attribute that not all of its vertices have";
  if (!fits(m.face_color, faces) || !fits(m.face_quality, faces) || !fits(m.face_selected, faces) ||
      !fits(m.wedges, faces))
    return "has an attribute that not all of its faces have";
  for (const Triangle& f : m.faces)
    for (int v : f)
      if (v < 0 || std::size_t(v) >= vertices) return "has a face with a vertex that does not exist";
  for (const Wedges& w : m.wedges)
    if (w.texture < -1 || w.texture >= int(m.textures.size())) return "has a face with a texture that does not exist";
  return "";
}

void fill_face_attributes(Mesh& mesh) {
  const std::size_t faces = mesh.faces.size();
  fill(mesh.face_color, faces, Color{255, 255, 255, 255});
  fill(mesh.face_quality, faces, 0.f);
  fill(mesh.face_selected, faces, char(0));
  fill(mesh.wedges, faces, Wedges());
}

}  // namespace parts::mesh
