// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace parts::mesh {

using Vec3 = Eigen::Vector3d;
using Box = Eigen::AlignedBox3d;
using Triangle = std::array<int, 3>;        ///< vertex indices, counter-clockwise from outside
using Color = std::array<std::uint8_t, 4>;  ///< RGBA

/// Texture coordinates of a face's three corners. texture indexes
/// Mesh::textures; -1 means that the face has none.
struct Wedges {
  std::array<Eigen::Vector2f, 3> uv{Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero()};
  int texture = -1;
};

/// An indexed triangle mesh in world space with the attributes that MeshLab
/// carries. Every optional array is either empty or has one entry an element.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> faces;

  std::vector<Eigen::Vector3f> vertex_normal;
  std::vector<Color> vertex_color;
  std::vector<float> vertex_quality;
  std::vector<Color> face_color;
  std::vector<float> face_quality;
  std::vector<Wedges> wedges;         ///< per face; per-vertex coordinates are read into these
  std::vector<std::string> textures;  ///< image files, as named by the mesh file

  std::vector<char> vertex_selected;  ///< 0 or 1
  std::vector<char> face_selected;

  int vertex_count() const { return int(vertices.size()); }
  int face_count() const { return int(faces.size()); }
  const Vec3& corner(int face, int k) const { return vertices[faces[face][k]]; }
  /// Along the face's normal, twice its area long.
  Vec3 area_vector(int face) const {
    return (corner(face, 1) - corner(face, 0)).cross(corner(face, 2) - corner(face, 0));
  }
  Vec3 normal(int face) const { return area_vector(face).normalized(); }  ///< zero of a face without area
  double area(int face) const { return 0.5 * area_vector(face).norm(); }
  Vec3 center(int face) const { return (corner(face, 0) + corner(face, 1) + corner(face, 2)) / 3; }
  Box face_box(int face) const {
    Box b(corner(face, 0));
    return b.extend(corner(face, 1)).extend(corner(face, 2));
  }
  /// The bounding box of the vertices that faces use.
  Box bounds() const {
    Box b;
    for (const Triangle& f : faces)
      for (int v : f) b.extend(vertices[v]);
    return b;
  }
};

}  // namespace parts::mesh

namespace parts {  // the words of every room
using mesh::Box;
using mesh::Color;
using mesh::Mesh;
using mesh::Triangle;
using mesh::Vec3;
using mesh::Wedges;
}  // namespace parts
