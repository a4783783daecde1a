// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::mesh {

/// What a surface amounts to once vertices at one place are one: what is left of
/// it in a file that has no indices. Flaws are lists of keys, sorted, made from
/// the places of what is flawed: the same flaw of two meshes has the same key.
struct SurfaceFigures {
  using Flaws = std::vector<std::uint64_t>;
  int pieces = 0;       ///< of faces joined by edges
  int borders = 0;      ///< boundary loops
  Flaws nonmanifold;    ///< edges of more than two faces
  Flaws pinches;        ///< vertices in which parts of the surface touch that no edge joins there
  Flaws flipped;        ///< edges whose two faces disagree about the outside
  Flaws crossings;      ///< pairs of faces, see intersecting_faces(); at most most_crossings
  int nonfinite = 0;    ///< faces with a coordinate that is not a number, or infinite
  double volume = 0;    ///< enclosed, borders closed by fans; negative where the inside is out
  double roundest = 0;  ///< the volume of a ball with this surface's area

  static constexpr int most_crossings = 100000;
};

/// @param threads  0 = all cores; the result does not depend on it
SurfaceFigures measure_surface(const Mesh& mesh, int threads = 0);

/// Of several surfaces, each by itself.
SurfaceFigures together(const std::vector<SurfaceFigures>& surfaces);

/// Of a mesh's parts, each by itself: they may cross and touch each other.
/// @param part  per face: the number of its part
SurfaceFigures measure_parts(const Mesh& mesh, const std::vector<char>& part, int threads = 0);

/// Takes the flaws of another mesh for known as well: the same surface as a
/// filter makes it ready, with other coordinates here and there.
void add_flaws(const SurfaceFigures& from, SurfaceFigures& to);

/// What is no flaw in a result although the inputs do not have it.
struct ResultRules {
  bool joins = false;     ///< more is asked: the inputs become one piece
  bool may_part = false;  ///< more pieces
  bool may_open = false;  ///< more borders, which may meet in a vertex
  bool moved = false;     ///< parts of the inputs lie elsewhere in it: flaws are compared by their number
};

/// Says what is worse in a result than in the inputs, as the end of a sentence
/// ("2 pieces where 1 is expected and 3 edges of more than two faces"); empty
/// where nothing is. Without inputs every flaw counts.
std::string worse_than_inputs(const SurfaceFigures& result, const std::vector<SurfaceFigures>& inputs,
                              const ResultRules& rules);

/// @throws std::logic_error  a face names a vertex or texture that is not there,
///                           or an attribute's array has another length
void check_arrays(const Mesh& mesh);

/// The mesh with coordinates in single precision, as the host keeps it.
Mesh in_single_precision(Mesh mesh);

}  // namespace parts::mesh
