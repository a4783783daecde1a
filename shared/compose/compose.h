// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"

namespace parts {

/// Which cut decides where one model ends and the other begins.
enum class Cut {
  Refined,  ///< a minimal vertex cut through the voxels that both surfaces share, a smooth border in them
  Thesis,   ///< equations 1 and 2 exactly as printed, borders along voxel sides
};

/// How the seam is smoothed after stitching (thesis 3.2.5): positions are
/// averaged with their neighbours'.
struct SeamSmoothing {
  int iterations = 3;
  double distance = 0;  ///< world units from the seam up to which vertices move; 0 = two voxels
  double weight = 0.5;  ///< 0..1, how far a vertex goes to its neighbours' mean
};

struct ComposeOptions {
  int resolution = 0;  ///< voxels along the longest side; 0 = from the meshes and the memory
  Cut cut = Cut::Refined;
  bool stitch = true;
  SeamSmoothing smoothing;
  bool transition_surface = false;  ///< compute ComposeResult::transition
  Box volume;                       ///< where the models may be joined; empty = their union's box
  int threads = 0;                  ///< 0 = all cores; the result does not depend on it
};

/// A model and the faces of it that must survive (one flag a face).
struct Part {
  Mesh mesh;
  std::vector<char> keep;
  std::string name = {};  ///< in error sentences; empty: "model A", "model B"
};

/// What a composition measured.
struct ComposeReport {
  std::array<int, 3> grid{0, 0, 0};  ///< voxels along x, y, z
  double voxel_size = 0;             ///< world units
  long voxels_a = 0, voxels_b = 0, voxels_both = 0;
  double cut_cost = 0;
  double cut_seconds = 0, seconds = 0;
  double seam_length = 0;  ///< world units
  double seam_gap = 0;     ///< mean distance between the borders before stitching, world units
  int loops_a = 0, loops_b = 0, loops_joined = 0, loops_capped = 0, loops_open = 0;
  int pieces_joined = 0;    ///< strips between borders that do not pair off one to one
  bool reversed_b = false;  ///< B's faces were turned to agree with A's
};

struct ComposeResult {
  Mesh composed;
  std::vector<char> face_from_b;  ///< per composed face: 0 from A, 1 from B, 2 made by the stitch
  Mesh clipped_a, clipped_b;
  Mesh transition;
  ComposeReport report;
};

/// Composes two overlapping meshes into one (thesis 3.1-3.2): a minimal cut
/// through their joint rasterisation finds where they are closest, both are
/// clipped there, stitched and smoothed. Faces away from the seam are copied
/// unchanged; every kept face is in the result.
/// @throws UserError  an empty model or constraint, a constraint outside the
///                    volume, models that do not touch, too little memory, …
/// @throws Cancelled
ComposeResult compose(const Part& a, const Part& b, const ComposeOptions& options, Progress& progress);

}  // namespace parts
