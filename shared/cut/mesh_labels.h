// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/cut/crossing_segments.h"
#include "parts/cut/seam_score.h"
#include "parts/cut/work_mesh.h"

namespace parts::cut {

/// A crossing segment as an edge of both work meshes: who is outside of whom.
/// One model's outside goes with the other's inside, or the seam there would be
/// one-sided, or inside out. Where the models touch back to back they count as
/// sunk into each other by a hair: the contact is inside. Where they part after
/// they were one surface, a_inside and b_outside are twins, and of the others
/// exactly one goes on.
struct Tie {
  int segment;                                   ///< of the curve
  int a_outside, a_inside, b_outside, b_inside;  ///< faces
  double length, turn;                           ///< turn: 1 - cosine between the normals of what is joined
  bool clear;                                    ///< the curve is no accident of nearly parallel faces
  bool hidden;                                   ///< inside another part of its own closed model
};

/// The two models ready for a cut.
struct MeshProblem {
  WorkMesh side[2];  ///< A, B
  std::vector<Tie> ties;
  double scale = 0;  ///< S: the RMS size of the smaller model, world units
};

/// Every face's territory.
struct MeshLabels {
  std::vector<Territory> label[2];  ///< per face of A's, of B's work mesh
  double reach = 0;                 ///< world units; how far the models could be apart
  double objective = 0;             ///< what it is chosen by, in units of SeamScore::total()
  double doubled = 0;  ///< what of it pays for faces that lie over each other and are both kept or both dropped
  long broken = 0;     ///< ties that do not hold
  bool found = false;
  bool possible = false;  ///< some cut obeys all marks, if without a seam
};

/// The best of the minimal cuts at growing reaches, from `reach` on.
/// @param more  how many to try beyond the first that breaks no tie and leaves no layer twice
/// @return found = false where the models do not meet between the marks
MeshLabels choose_labels(MeshProblem& problem, double reach, int more, int threads);

}  // namespace parts::cut
