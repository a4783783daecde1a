// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "parts/cut/crossing_segments.h"
#include "parts/cut/cut.h"
#include "parts/cut/mesh_labels.h"
#include "parts/spatial/face_tree.h"

/// Where the work meshes of two models are one: which faces lie on each other,
/// and which of those at a common edge are decided together.
namespace parts::cut {

/// The same for an edge either way.
inline std::uint64_t edge_key(int a, int b) {
  return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

/// Per vertex of a work mesh the first point of both models there, or -1.
std::vector<int> points_at(const WorkMesh& w, const CrossingCurve& curve);

/// Faces of both between the same points: one surface, if they look the same way.
void find_twins(MeshProblem& problem, const CrossingCurve& curve);

/// Ties the faces at crossing segments that are edges of both work meshes.
/// @param model, tree  A's and B's; the trees are over the models' faces
void find_ties(MeshProblem& problem, const CrossingCurve& curve, const std::array<const Model*, 2>& model,
               const spatial::FaceTree (&tree)[2]);

}  // namespace parts::cut
