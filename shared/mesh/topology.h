// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/mesh/loops.h"

namespace parts::mesh {

/// Which side of which face lies across each half-edge. Half-edge 3 f + k goes
/// from corner k of face f to its corner k + 1. Faces with a repeated vertex
/// have no half-edges: theirs are kNone.
struct EdgeMap {
  static constexpr int kBoundary = -1, kNonManifold = -2, kNone = -3;
  std::vector<int> mate;  ///< per half-edge: the other one of its edge, or one of the above
  int edges = 0;          ///< undirected ones
  int boundary_edges = 0;
  int nonmanifold_edges = 0;   ///< of more than two faces
  int inconsistent_edges = 0;  ///< two faces run along it in the same direction
};
EdgeMap edge_map(const Mesh& mesh);

/// The borders of the surface in the faces' order, each once around a hole.
/// Where holes touch at a vertex a border follows the fan of faces that it
/// bounds; one that ends at non-manifold edges is a chain.
std::vector<Loop> boundary_loops(const Mesh& mesh, const EdgeMap& map);

/// Per vertex, 1 = it lies on an edge of more than two faces, or its faces are not one fan.
std::vector<char> nonmanifold_vertices(const Mesh& mesh, const EdgeMap& map);

/// Per vertex a number of its component, faces joined by vertices; not in a row.
std::vector<int> vertex_components(const Mesh& mesh);

/// What is wrong with a surface, counted.
struct MeshCheck {
  int vertices = 0;  ///< that faces use
  int edges = 0;
  int faces = 0;       ///< without those that repeat a vertex
  int components = 0;  ///< of faces joined by edges
  int euler = 0;       ///< vertices - edges + faces
  int boundary_edges = 0;
  int boundary_loops = 0;
  int nonmanifold_edges = 0;
  int nonmanifold_vertices = 0;  ///< whose faces are not one fan
  int inconsistent_edges = 0;
  int degenerate_faces = 0;    ///< that repeat a vertex, or have exactly no area
  int nonfinite_vertices = 0;  ///< with a coordinate that is not a number, or infinite
  int unused_vertices = 0;

  bool manifold() const { return nonmanifold_edges == 0 && nonmanifold_vertices == 0; }
  bool closed() const { return boundary_edges == 0; }
  bool oriented() const { return inconsistent_edges == 0; }
};

/// @pre all vertex indices of faces are in range
MeshCheck check(const Mesh& mesh);

/// One "name: value" a line.
std::string to_string(const MeshCheck& c);

}  // namespace parts::mesh
