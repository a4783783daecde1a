// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/base/disjoint_sets.h"
#include "parts/cut/isolated.h"
#include "parts/cut/labels.h"
#include "parts/cut/max_flow.h"

namespace parts::cut {
namespace {

/// Components of the graph that hold no constraint at all take the label of
/// what is nearest; an outer piece that leads nowhere stays.
void label_unconstrained(const JointVoxels& voxels, VoxelLabels& cut) {
  const int n = int(voxels.size()), pieces = int(voxels.outer.size());
  DisjointSets sets(n + pieces);
  for_each_edge(voxels.grid, voxels.set, voxels.cells, [&](int p, int q) { sets.unite(p, q); });
  for (int k = 0; k < pieces; ++k)
    for (std::size_t v : voxels.outer[k].voxels) sets.unite(voxels.set.node(v), n + k);
  std::vector<char> constrained(n + pieces, 0);
  for (int p = 0; p < n; ++p)
    if (voxels.flags[p] & (kKeepA | kKeepB)) constrained[sets.find(p)] = 1;
  for (int k = 0; k < pieces; ++k)
    if (voxels.outer[k].keep) constrained[sets.find(n + k)] = 1;

  std::vector<int> group(n, -1), group_of(n + pieces, -1);
  int groups = 0;
  for (int p = 0; p < n; ++p)
    if (const int root = sets.find(p); !constrained[root]) {
      if (group_of[root] < 0) group_of[root] = groups++;
      group[p] = group_of[root];
    }
  label_isolated(voxels, group, groups, cut.label);
  for (int k = 0; k < pieces; ++k)
    if (!constrained[sets.find(n + k)]) cut.outer[k] = voxels.outer[k].of_a ? VoxelLabels::kA : VoxelLabels::kB;
}

}  // namespace

VoxelLabels thesis_cut(const JointVoxels& voxels) {
  const int n = int(voxels.size()), pieces = int(voxels.outer.size());
  long edges = 0, at_intersection = 0;
  for_each_edge(voxels.grid, voxels.set, voxels.cells, [&](int p, int q) {
    ++edges;
    at_intersection += voxels.both(p) || voxels.both(q);
  });
  long piece_links = 0;
  for (const OuterPiece& piece : voxels.outer)
    for (std::size_t v : piece.voxels) ++piece_links, at_intersection += voxels.both(voxels.set.node(v));
  const int boundary_weight = int(std::min<long>(at_intersection + 1, kUncuttable / 2));

  FlowGraph graph(n + pieces, int(edges + piece_links));
  graph.add_node(n + pieces);
  for_each_edge(voxels.grid, voxels.set, voxels.cells, [&](int p, int q) {
    const int w = voxels.both(p) || voxels.both(q) ? 1 : boundary_weight;
    graph.add_edge(p, q, w, w);
  });
  const auto tie = [&](int node, bool to_a, bool to_b) {
    graph.add_tweights(node, to_a ? kUncuttableTerminal : 0, to_b ? kUncuttableTerminal : 0);
  };
  for (int p = 0; p < n; ++p)
    if (voxels.flags[p] & (kKeepA | kKeepB)) tie(p, voxels.flags[p] & kKeepA, voxels.flags[p] & kKeepB);
  for (int k = 0; k < pieces; ++k) {
    const OuterPiece& piece = voxels.outer[k];
    if (piece.keep) tie(n + k, piece.of_a, !piece.of_a);
    for (std::size_t v : piece.voxels) {
      const int node = voxels.set.node(v), w = voxels.both(node) ? 1 : kUncuttable;
      graph.add_edge(n + k, node, w, w);
    }
  }

  VoxelLabels cut;
  const std::int64_t flow = graph.maxflow();
  cut.connected = flow > 0;
  // Back to the thesis' unit: an intersection edge costs 1/(10k).
  long k = 0;
  for (int p = 0; p < n; ++p) k += voxels.both(p);
  const std::int64_t boundary = flow / boundary_weight;
  cut.cost = double(boundary) + double(flow % boundary_weight) / (10.0 * double(std::max(k, 1L)));
  // Ties go to B, which leaves the cut nearest to A's constraint.
  const auto label = [&](int node) {
    return std::int8_t(graph.what_segment(node, FlowGraph::SINK) == FlowGraph::SOURCE ? VoxelLabels::kA
                                                                                      : VoxelLabels::kB);
  };
  for (int p = 0; p < n; ++p) cut.label.push_back(label(p));
  for (int j = 0; j < pieces; ++j) cut.outer.push_back(label(n + j));
  label_unconstrained(voxels, cut);
  return cut;
}

}  // namespace parts::cut
