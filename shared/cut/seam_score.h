// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/mesh.h"

namespace parts::cut {

/// An edge of the border that a cut gives a model.
struct BorderEdge {
  Vec3 from, to;
  Vec3 normal;  ///< unit, of the face that is kept there
};

/// A cut model's borders.
struct Borders {
  std::vector<BorderEdge> cut;  ///< made by the cut
  std::vector<BorderEdge> own;  ///< of the model itself, that a cut of the other may face
};

/// How good a seam is: J = (gap + length + turn + unfaced) / (lambda S), the
/// parts being sums over the border edges of both models of half their length
/// times a weight. In it S is the models' size and lambda = 0.01 S.
struct SeamScore {
  double gap = 0;      ///< distance to the other border, at most 0.1 S
  double length = 0;   ///< lambda
  double turn = 0;     ///< lambda (1 - cosine) of the angle across
  double unfaced = 0;  ///< 0.1 S where no border lies within 0.1 S
  double scale = 0;    ///< S, world units

  static constexpr double kLambda = 0.01, kReach = 0.1;  // of S
  double total() const { return scale > 0 ? (gap + length + turn + unfaced) / (kLambda * scale * scale) : 0; }
};

SeamScore score_seam(const Borders& a, const Borders& b, double scale);

/// The area-weighted root-mean-square distance of a surface from its centroid.
double rms_size(const Mesh& mesh);

/// The borders of a model's clipped mesh; those that lie on the model's own are `own`.
Borders borders_of(const Mesh& model, const Mesh& clipped);

}  // namespace parts::cut
