// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// Per vertex: the first vertex with the same position, bit for bit; those that
/// are not finite are by themselves.
std::vector<int> first_at_same_place(const Mesh& mesh);

/// The mesh with each face between the first vertices at its corners' places.
/// Vertices and faces keep their numbers; attributes are left out.
Mesh welded(const Mesh& mesh);

/// A mesh made fit for cutting, and what had to be done to it.
struct Prepared {
  Mesh mesh;
  std::vector<int> source_face;  ///< per face: its index in the input
  std::vector<int> component;    ///< per face: number of its edge-connected component
  std::vector<char> closed;      ///< per component: no boundary edge
  int components = 0;
  int welded_vertices = 0;  ///< vertices that lay exactly on another one
  int dropped_faces = 0;    ///< with non-finite coordinates, a repeated vertex, or a repeated face
  int reversed_faces = 0;   ///< turned to agree with their neighbours
};

/// Welds vertices with bit-identical positions (surfaces that only touch in one
/// stay apart), drops faces that are none, and
/// turns faces so that neighbours across manifold edges agree (within a
/// component the larger area wins). Zero-area faces stay: they keep a surface
/// closed. Attributes follow; of welded vertices the first's stay.
Prepared prepare(const Mesh& mesh);

}  // namespace parts::mesh
