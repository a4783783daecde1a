// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/loops.h"
#include "parts/mesh/topology.h"

namespace parts::mend {

/// In place of the number of a scan's face, of those that it has not had.
enum NewFace : int { kFromModel = -1, kFromStitch = -2 };

/// The closed borders of a surface that bound a hole, in the direction of its
/// faces. Where borders meet in a place, in vertices of their own, each goes on
/// along the hole, so that holes that touch are rims by themselves and a tooth
/// that hangs in a vertex is part of the rim around it; such a rim steps from
/// one vertex to another at the same place.
/// @param mesh  no vertex has several fans
std::vector<mesh::Loop> find_rims(const Mesh& mesh, int* chains = nullptr);

/// A scan ready for mending, and what is known of its surface: made once, and
/// again where a patch has changed it.
class Scan {
 public:
  /// Welds within the coordinates' own step, turns faces to agree, gives fans
  /// that touch in a vertex one of their own each, and drops crumbs that hung in such.
  explicit Scan(const Mesh& input);
  /// The scan after a change. @param origin  a face: its number in the first scan, or a NewFace
  Scan(Mesh mesh, std::vector<int> origin);

  const Mesh& mesh() const { return mesh_; }
  const std::vector<int>& origin() const { return origin_; }
  const std::vector<mesh::Loop>& rims() const { return rims_; }
  int chains() const { return chains_; }  ///< borders that end at edges of more than two faces: no rims
  int crumbs() const { return crumbs_; }  ///< faces of the input that were dropped as such
  /// Per vertex a number of its component, faces joined by vertices; not in a row.
  const std::vector<int>& component() const { return component_; }
  /// Per vertex: the faces of its component.
  const std::vector<int>& component_faces() const { return component_faces_; }

 private:
  void survey();

  int crumbs_ = 0;
  Mesh mesh_;
  std::vector<int> origin_;
  std::vector<mesh::Loop> rims_;
  int chains_ = 0;
  std::vector<int> component_, component_faces_;
};

}  // namespace parts::mend
