// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/judge.h"

#include "parts/mesh/prepare.h"
#include "parts/mesh/self_intersections.h"
#include "parts/mesh/topology.h"

namespace parts::compose {

SurfaceFigures figures_of(const Mesh& mesh, int threads) {
  // As the composition sees it: vertices at one place are one.
  const Mesh surface = mesh::prepare(mesh).mesh;
  const mesh::MeshCheck c = mesh::check(surface);
  return {c.components, c.boundary_loops, c.nonmanifold_edges + c.nonmanifold_vertices + c.inconsistent_edges,
          mesh::self_intersections(surface, 0, threads)};
}

Judgement judge(const Mesh& a, const Mesh& b, const ComposeResult& result, int threads) {
  Judgement j;
  j.seam = cut::score_seam(cut::borders_of(a, result.clipped_a), cut::borders_of(b, result.clipped_b),
                           std::min(cut::rms_size(a), cut::rms_size(b)));
  j.unfaced_length = 2 * j.seam.unfaced / (cut::SeamScore::kReach * j.seam.scale);
  j.a = figures_of(a, threads), j.b = figures_of(b, threads), j.result = figures_of(result.composed, threads);
  return j;
}

std::vector<std::string> shortcomings(const SurfaceFigures& inputs, const SurfaceFigures& result, bool stitched) {
  std::vector<std::string> found;
  const auto more = [&](const char* what, long of_result, long of_inputs, const char* remedy) {
    if (of_result > of_inputs)
      found.push_back("The result has " + std::to_string(of_result) + " " + what + ", the models have " +
                      std::to_string(of_inputs) + "; " + remedy);
  };
  const int pieces = stitched ? std::max(1, inputs.pieces - 1) : inputs.pieces;
  more("pieces", result.pieces, pieces, "move the models farther into each other, or mark what must go.");
  if (stitched)
    more("border loops", result.border_loops, inputs.border_loops,
         "move the models farther into each other, or close what is left with a hole filter.");
  more("non-manifold or disagreeing edges and vertices", result.bad_elements, inputs.bad_elements,
       "clean the result, or mark parts that leave the cut more room.");
  more("pairs of crossing faces", result.crossings, inputs.crossings,
       "look at the seam; smooth it more, or mark parts that leave the cut more room.");
  return found;
}

}  // namespace parts::compose
