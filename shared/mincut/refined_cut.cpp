// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/disjoint_sets.h"
#include "mincut/isolated.h"
#include "mincut/labels.h"
#include "mincut/max_flow.h"

namespace parts {
namespace {

/// Every voxel within `reach` of a set voxel, in the largest coordinate.
VoxelSet dilated(const Grid& grid, const VoxelSet& set, int reach) {
  if (reach == 0) return set;
  VoxelSet wide(grid.count());
  set.for_each([&](std::size_t v) {
    const std::array<int, 3> c = grid.cell(v);
    for (int k = std::max(0, c[2] - reach); k <= std::min(grid.dims[2] - 1, c[2] + reach); ++k)
      for (int j = std::max(0, c[1] - reach); j <= std::min(grid.dims[1] - 1, c[1] + reach); ++j)
        for (int i = std::max(0, c[0] - reach); i <= std::min(grid.dims[0] - 1, c[0] + reach); ++i)
          wide.add(grid.index(i, j, k));
  });
  return wide;
}

/// The places of the refined graph: every non-empty voxel, and every voxel that
/// both models come near. Places outside the overlap are gathered into sheets.
struct Places {
  VoxelSet set;
  std::vector<std::size_t> cells;
  std::vector<int> voxel;    ///< place -> node of JointVoxels, -1 if empty
  std::vector<char> shared;  ///< an intersection voxel
  std::vector<int> depth;    ///< steps from the rim of the overlap, capped
};

constexpr int kDeepest = 8;

Places find_places(const JointVoxels& voxels, int reach) {
  VoxelSet a(voxels.grid.count()), b(voxels.grid.count());
  for (long n = 0; n < voxels.size(); ++n) {
    if (voxels.flags[n] & kHasA) a.add(voxels.cells[n]);
    if (voxels.flags[n] & kHasB) b.add(voxels.cells[n]);
  }
  VoxelSet shared = dilated(voxels.grid, a, reach);
  shared &= dilated(voxels.grid, b, reach);
  Places p;
  p.set = voxels.set;
  p.set |= shared;
  p.set.index();
  p.cells = p.set.cells();
  p.voxel.resize(p.cells.size());
  p.shared.resize(p.cells.size());
  for (std::size_t i = 0; i < p.cells.size(); ++i) {
    p.voxel[i] = voxels.set.node(p.cells[i]);
    p.shared[i] = shared.has(p.cells[i]);
  }

  p.depth.assign(p.cells.size(), kDeepest);
  std::vector<std::pair<int, int>> inner;
  for_each_edge(voxels.grid, p.set, p.cells, [&](int i, int j) {
    if (p.shared[i] && p.shared[j])
      inner.emplace_back(i, j);
    else if (p.shared[i])
      p.depth[i] = 0;
    else if (p.shared[j])
      p.depth[j] = 0;
  });
  for (int round = 1; round < kDeepest; ++round)
    for (const auto& [i, j] : inner) {
      if (p.depth[i] == round - 1) p.depth[j] = std::min(p.depth[j], round);
      if (p.depth[j] == round - 1) p.depth[i] = std::min(p.depth[i], round);
    }
  return p;
}

/// 64 for the best place to pass, more where the models differ.
int seam_weight(const Places& places, int place, const std::vector<Eigen::Vector3f>& normal_a,
                const std::vector<Eigen::Vector3f>& normal_b) {
  double weight = 32.0 * (1.0 + 1.0 / (1 + places.depth[place]));
  const int v = places.voxel[place];
  if (v < 0) return int(weight);
  const Eigen::Vector3f &a = normal_a[v], &b = normal_b[v];
  if (a.squaredNorm() > 0 && b.squaredNorm() > 0) weight *= 2.0 - double(a.normalized().dot(b.normalized()));
  return std::max(1, int(weight));
}

/// Node numbers of the flow graph: a sheet is one node, a shared place two (its
/// entry and, one above, its exit), an outer piece belongs to a sheet.
struct Nodes {
  std::vector<int> of_place, of_piece;
  int count = 0;
};

Nodes number_nodes(const JointVoxels& voxels, const Places& places) {
  const int n = int(places.cells.size()), pieces = int(voxels.outer.size());
  DisjointSets sheets(n + pieces);
  const auto only = [&](int i) { return voxels.flags[places.voxel[i]] & 3; };
  for_each_edge(voxels.grid, places.set, places.cells, [&](int i, int j) {
    if (!places.shared[i] && !places.shared[j] && only(i) == only(j)) sheets.unite(i, j);
  });
  for (int k = 0; k < pieces; ++k)
    for (std::size_t v : voxels.outer[k].voxels) {
      const int i = places.set.node(v);
      if (!places.shared[i] && only(i) == (voxels.outer[k].of_a ? kHasA : kHasB)) sheets.unite(i, n + k);
    }
  std::vector<int> number(n + pieces, -1);
  Nodes nodes;
  for (int i = 0; i < n + pieces; ++i)
    if (const int root = sheets.find(i); number[root] < 0) {
      number[root] = nodes.count;
      nodes.count += i < n && places.shared[i] ? 2 : 1;
    }
  for (int i = 0; i < n; ++i) nodes.of_place.push_back(number[sheets.find(i)]);
  for (int k = 0; k < pieces; ++k) nodes.of_piece.push_back(number[sheets.find(n + k)]);
  return nodes;
}

/// Calls visit(node, node, is place shared?) for each pair that no cut may part.
template <class Visit>
void for_each_link(const JointVoxels& voxels, const Places& places, const Nodes& nodes, const Visit& visit) {
  for_each_edge(voxels.grid, places.set, places.cells, [&](int i, int j) {
    if (places.shared[i] || places.shared[j])
      visit(nodes.of_place[i], places.shared[i] != 0, nodes.of_place[j], places.shared[j] != 0);
  });
  for (std::size_t k = 0; k < voxels.outer.size(); ++k)
    for (std::size_t v : voxels.outer[k].voxels)
      if (const int i = places.set.node(v); places.shared[i])
        visit(nodes.of_piece[k], false, nodes.of_place[i], true);
}

/// What is found in a region that the seam bounds.
struct Region {
  bool source = false, sink = false, seam = false, shared = false;
  long only_a = 0, only_b = 0;
};

std::int8_t label_of(const Region& r) {
  if (r.source) return VoxelLabels::kA;
  if (r.sink) return VoxelLabels::kB;
  // Cut off from both constraints: a sheet of one model alone goes, so that
  // both models lose a side where they cross; otherwise the larger share stays.
  if (!r.shared) return r.only_a ? VoxelLabels::kB : VoxelLabels::kA;
  return r.only_a > r.only_b ? VoxelLabels::kA : VoxelLabels::kB;
}

}  // namespace

VoxelLabels refined_cut(const JointVoxels& voxels, const std::vector<Eigen::Vector3f>& normal_a,
                        const std::vector<Eigen::Vector3f>& normal_b, const RefinedOptions& options) {
  const Places places = find_places(voxels, options.reach);
  const Nodes nodes = number_nodes(voxels, places);
  const int n = int(places.cells.size()), pieces = int(voxels.outer.size());

  FlowGraph graph(nodes.count, n * 4);
  graph.add_node(nodes.count);
  for (int i = 0; i < n; ++i) {
    const int node = nodes.of_place[i], entry = node, exit = node + (places.shared[i] ? 1 : 0);
    if (places.shared[i]) graph.add_edge(entry, exit, seam_weight(places, i, normal_a, normal_b), 0);
    const int flags = places.voxel[i] < 0 ? 0 : voxels.flags[places.voxel[i]];
    if (flags & kKeepA) graph.add_tweights(entry, kUncuttableTerminal, 0);
    if (flags & kKeepB) graph.add_tweights(exit, 0, kUncuttableTerminal);
  }
  for (int k = 0; k < pieces; ++k)
    if (voxels.outer[k].keep)
      graph.add_tweights(nodes.of_piece[k], voxels.outer[k].of_a ? kUncuttableTerminal : 0,
                         voxels.outer[k].of_a ? 0 : kUncuttableTerminal);
  for_each_link(voxels, places, nodes, [&](int p, bool p_shared, int q, bool q_shared) {
    const int p_exit = p + p_shared, q_exit = q + q_shared;
    graph.add_edge(p_exit, q, kUncuttable, 0);
    graph.add_edge(q_exit, p, kUncuttable, 0);
  });
  VoxelLabels cut;
  const std::int64_t flow = graph.maxflow();
  cut.cost = double(flow) / 64.0;
  cut.connected = flow > 0;

  // The seam: entry reached from the source, exit not. What it leaves falls
  // into regions.
  const auto reached = [&](int node) { return graph.what_segment(node, FlowGraph::SINK) == FlowGraph::SOURCE; };
  std::vector<char> seam(nodes.count, 0);
  for (int i = 0; i < n; ++i)
    if (const int node = nodes.of_place[i]; places.shared[i] && reached(node) && !reached(node + 1)) seam[node] = 1;
  DisjointSets sets(nodes.count);
  for_each_link(voxels, places, nodes, [&](int p, bool, int q, bool) {
    if (!seam[p] && !seam[q]) sets.unite(p, q);
  });
  std::vector<Region> region(nodes.count);
  for_each_link(voxels, places, nodes, [&](int p, bool, int q, bool) {
    if (seam[p] != seam[q]) region[sets.find(seam[p] ? q : p)].seam = true;
  });
  for (int i = 0; i < n; ++i) {
    const int node = nodes.of_place[i], flags = places.voxel[i] < 0 ? 0 : voxels.flags[places.voxel[i]];
    if (seam[node]) continue;
    Region& r = region[sets.find(node)];
    r.source |= reached(node);
    r.sink |= (flags & kKeepB) != 0;
    if (places.shared[i])
      r.shared = true;
    else
      ++(flags & kHasA ? r.only_a : r.only_b);
  }
  for (int k = 0; k < pieces; ++k) {
    Region& r = region[sets.find(nodes.of_piece[k])];
    r.source |= reached(nodes.of_piece[k]);
    r.sink |= voxels.outer[k].keep && !voxels.outer[k].of_a;
    ++(voxels.outer[k].of_a ? r.only_a : r.only_b);
  }

  cut.label.assign(voxels.size(), VoxelLabels::kSeam);
  std::vector<int> group(voxels.size(), -1), group_of(nodes.count, -1);
  int groups = 0;
  for (int i = 0; i < n; ++i) {
    const int node = nodes.of_place[i], v = places.voxel[i];
    if (v < 0 || seam[node]) continue;
    const int root = sets.find(node);
    const Region& r = region[root];
    if (r.source || r.sink || r.seam) {
      cut.label[v] = label_of(r);
    } else {
      if (group_of[root] < 0) group_of[root] = groups++;
      group[v] = group_of[root];
    }
  }
  label_isolated(voxels, group, groups, cut.label);
  for (int k = 0; k < pieces; ++k) {
    const Region& r = region[sets.find(nodes.of_piece[k])];
    cut.outer.push_back(r.source || r.sink || r.seam ? label_of(r)
                                                     : std::int8_t(voxels.outer[k].of_a ? VoxelLabels::kA : VoxelLabels::kB));
  }
  return cut;
}

}  // namespace parts
