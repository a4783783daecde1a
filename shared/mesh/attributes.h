// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/mesh.h"

namespace parts::mesh {

// Changing a mesh so that every attribute goes with what it belongs to.

/// Adds the point (1 - t) v_i + t v_j. @return its index
int add_vertex_between(Mesh& mesh, int i, int j, double t);

/// Adds the point of a face at barycentric coordinates. @return its index
int add_vertex_within(Mesh& mesh, int face, const Vec3& barycentric);

/// Adds a face that lies within face `parent`; corner k of it is at the
/// barycentric coordinates barycentric[k] of the parent. @return its index
int add_face_within(Mesh& mesh, int parent, const Triangle& vertices, const std::array<Vec3, 3>& barycentric);

/// Adds a face that has no parent, dressed as face `like` (texture coordinates:
/// those of like's nearest corners). @return its index
int add_face_like(Mesh& mesh, int like, const Triangle& vertices);

/// The faces with flag 1 and the vertices that they use, in their order.
/// @param old_vertex, old_face  optional: their indices in `mesh`
Mesh take_faces(const Mesh& mesh, const std::vector<char>& flags, std::vector<int>* old_vertex = nullptr,
                std::vector<int>* old_face = nullptr);

/// Adds all of `from`. Where only one of the two has an attribute, the other
/// gets a neutral one (white, quality 0, no texture).
void append(Mesh& to, const Mesh& from);

/// Turns every face over.
void flip_orientation(Mesh& mesh);

/// The mesh moved: vertices, normals, and faces turned over where the map mirrors.
Mesh transformed(Mesh mesh, const Eigen::Affine3d& map);

/// Area-weighted vertex normals from the faces.
void update_normals(Mesh& mesh);

}  // namespace parts::mesh
