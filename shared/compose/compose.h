// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/base/progress.h"
#include "parts/cut/cut.h"
#include "parts/cut/volume.h"
#include "parts/mesh/mesh.h"
#include "parts/seam/blend.h"
#include "parts/seam/seam.h"

namespace parts::compose {

struct ComposeOptions {
  int resolution = 0;  ///< Thesis: voxels along the longest side; 0 = from the meshes and the memory
  cut::Cut cut = cut::Cut::Mesh;
  bool stitch = true;
  seam::SeamSmoothing smoothing;
  bool transition_surface = false;  ///< compute ComposeResult::transition
  Box volume;                       ///< where the models may be joined; empty = their union's box
  int threads = 0;                  ///< 0 = all cores; the result does not depend on it
};

/// What a composition measured.
struct ComposeReport : cut::CutReport, seam::SeamReport {
  cut::Cut cut = cut::Cut::Mesh;  ///< that made the result; Thesis also where the seam of Mesh had more flaws
  seam::SeamBlend blend;
  double seconds = 0;
};

struct ComposeResult {
  Mesh composed;
  std::vector<char> face_from_b;  ///< per composed face: 0 from A, 1 from B, 2 made by the stitch
  Mesh clipped_a, clipped_b;
  Mesh transition;
  ComposeReport report;
};

/// Composes two overlapping meshes into one (thesis 3.1-3.2): a minimal cut on
/// the meshes, or through their voxels, finds where they are closest, both are
/// clipped there, stitched and smoothed. Faces away from the seam are copied
/// unchanged; every kept face is in the result.
/// @throws UserError  an empty model or constraint, a constraint outside the
///                    volume, models that do not touch, too little memory, …
/// @throws Cancelled
ComposeResult compose(const cut::Part& a, const cut::Part& b, const ComposeOptions& options, Progress& progress);

}  // namespace parts::compose
