// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::mend {

/// Smooth vector fields over the vertices of a surface, known only here and
/// there: the field u that minimises
///     sum_i w_i A_i |u_i - t_i|^2  +  length^4 * integral |laplacian u|^2
/// (A_i the vertex areas; the cotangent Laplacian, as in Botsch and Kobbelt,
/// "An intuitive framework for real-time freeform modeling", 2004). Where no
/// target has weight, the field goes on from where it is known without a kink.
class SmoothField {
 public:
  /// @param mesh  every vertex belongs to a face; may have borders, several
  ///              components and edges of more than two faces
  explicit SmoothField(const Mesh& mesh);
  ~SmoothField();

  /// @param weight  a vertex, 0 = unknown. A component without any takes the
  ///                values of the nearest vertices that have one.
  /// @param length  world units: details of the targets smaller than this are smoothed away
  /// @return a vector a vertex; not numbers if the surface is too degenerate to be solved on
  std::vector<Vec3> operator()(const std::vector<Vec3>& target, const std::vector<double>& weight, double length);

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace parts::mend
