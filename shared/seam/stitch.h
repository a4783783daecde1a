// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/loops.h"

namespace parts::seam {

/// How far two facing contours run the same way, from -1 (opposite) to 1: the
/// dot product of the directions from their nearest vertices to those 10 % of
/// the way on (thesis 3.2.5), averaged over starts all along the contours.
double direction_agreement(const Mesh& mesh, const mesh::Loop& a, const mesh::Loop& b);

/// Zippers the gap between two facing contours, a's half-edges and b's running
/// opposite ways. Of all strips between them the one with the shortest cross
/// edges is taken, from the nearest pair of vertices on. Faces are added to the
/// mesh, dressed as face like[v] of the nearest contour vertex v.
void zipper(Mesh& mesh, const mesh::Loop& a, const mesh::Loop& b, const std::vector<int>& like);

/// The same between two polylines of vertices that run the same way, p's
/// half-edges along it and q's against it, from first vertices to last.
void zipper_lines(Mesh& mesh, const std::vector<int>& p, const std::vector<int>& q, const std::vector<int>& like);

}  // namespace parts::seam
