// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mend/scan.h"

namespace parts::mend {

/// Why a patch is not accepted, the graver the later: of several tries, the
/// last of these says how near they came.
enum class Objection {
  NoSurface,     ///< the model has none that continues the scan
  Open,          ///< a rim that was to be closed is open, or something else is
  NonManifold,   ///< an edge or vertex is no manifold, and was not so before
  FarFromModel,  ///< new faces lie off the model
  Crosses,       ///< new faces cross the scan's
  Unlike,        ///< a smooth surface foretells the scan beside it better than the model does
  None,          ///< it is accepted
};

/// In words, to follow "because".
const char* words(Objection objection);

/// A patch and what it was to be.
struct Trial {
  const Mesh& before;                   ///< the scan, open
  const std::vector<mesh::Loop>& rims;  ///< of it: to be closed
  const Mesh& after;
  const std::vector<int>& source;  ///< per face of `after`: its number in `before`, or a NewFace
  const Mesh& model;               ///< as it was fitted
  double near = 0;                 ///< how far from the model new faces may lie, world units
  int threads = 0;
  std::vector<char> crossed = {};  ///< per face of `before`, 1 = of a piece that was crossed already; empty: none is
};

/// Judges what a file would hold, vertices at the same place made one: closed
/// is not right.
Objection objection_to(const Trial& trial);

}  // namespace parts::mend
