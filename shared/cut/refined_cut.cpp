// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>

#include "parts/base/disjoint_sets.h"
#include "parts/cut/isolated.h"
#include "parts/cut/labels.h"
#include "parts/cut/max_flow.h"

namespace parts::cut {
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

constexpr int kUnit = 64;  // capacity of the best voxel to pass

/// kUnit for the best place to pass, more where the models differ.
int seam_weight(const Places& places, int place, const std::vector<Eigen::Vector3f>& normal_a,
                const std::vector<Eigen::Vector3f>& normal_b) {
  double weight = 0.5 * kUnit * (1.0 + 1.0 / (1 + places.depth[place]));
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
      if (const int i = places.set.node(v); places.shared[i]) visit(nodes.of_piece[k], false, nodes.of_place[i], true);
}

/// The state of a refined cut while its sheets' sides are being settled.
class RefinedCut {
 public:
  RefinedCut(const JointVoxels& voxels, const std::vector<Eigen::Vector3f>& normal_a,
             const std::vector<Eigen::Vector3f>& normal_b, int reach)
      : voxels_(voxels), reach_(reach), places_(find_places(voxels, reach)), nodes_(number_nodes(voxels, places_)) {
    for (int i = 0; i < int(places_.cells.size()); ++i)
      weight_.push_back(places_.shared[i] ? seam_weight(places_, i, normal_a, normal_b) : 0);
    of_a_.assign(nodes_.count, 0);
    for (int i = 0; i < int(places_.cells.size()); ++i)
      if (!places_.shared[i]) of_a_[nodes_.of_place[i]] = (flags(i) & kHasA) != 0;
    source_.assign(nodes_.count, 0), sink_ = source_;
    for (int i = 0; i < int(places_.cells.size()); ++i) {
      const int node = nodes_.of_place[i];
      if (flags(i) & kKeepA) source_[node] = 1;
      if (flags(i) & kKeepB) sink_[node + (places_.shared[i] ? 1 : 0)] = 1;
    }
    for (std::size_t k = 0; k < voxels_.outer.size(); ++k) {
      const bool of_a = voxels_.outer[k].of_a;
      of_a_[nodes_.of_piece[k]] = of_a;
      if (voxels_.outer[k].keep) (of_a ? source_ : sink_)[nodes_.of_piece[k]] = 1;
    }
    tie_crossing_sheets(normal_a, normal_b);
  }

  void solve();
  VoxelLabels labels() const;

  double cost = 0;

 private:
  /// What lies between seams.
  struct Region {
    bool source = false, sink = false, seam = false, shared = false;
    long only_a = 0, only_b = 0;
    std::int8_t label() const {
      if (source) return VoxelLabels::kA;
      if (sink) return VoxelLabels::kB;
      // Cut off from both constraints: a sheet of one model alone is dropped;
      // of several the larger share stays.
      if (!shared) return only_a ? VoxelLabels::kB : VoxelLabels::kA;
      return only_a > only_b ? VoxelLabels::kA : VoxelLabels::kB;
    }
  };

  int flags(int place) const { return places_.voxel[place] < 0 ? 0 : voxels_.flags[places_.voxel[place]]; }
  void tie_crossing_sheets(const std::vector<Eigen::Vector3f>& normal_a, const std::vector<Eigen::Vector3f>& normal_b);
  void find_regions();
  const Region& region(int node) const { return regions_[region_of_[node]]; }

  const JointVoxels& voxels_;
  int reach_;
  Places places_;
  Nodes nodes_;
  std::vector<int> weight_;  ///< per place
  std::vector<char> of_a_;   ///< per node that is a sheet: a region that one model alone occupies, here A
  std::map<std::pair<int, int>, int>
      ties_;                         ///< (sheet of A, of B) -> voxels that ask not to keep both, less those that do not
  std::vector<char> source_, sink_;  ///< per node: tied to a terminal
  std::vector<char> reached_, seam_;  ///< per node, after solve()
  std::vector<int> region_of_;        ///< per node
  std::vector<Region> regions_;
};

void RefinedCut::solve() {
  const int n = int(places_.cells.size());
  FlowGraph graph(nodes_.count, n * 4);
  graph.add_node(nodes_.count);
  for (int i = 0; i < n; ++i)
    if (places_.shared[i]) graph.add_edge(nodes_.of_place[i], nodes_.of_place[i] + 1, weight_[i], 0);
  for (int node = 0; node < nodes_.count; ++node)
    if (source_[node] || sink_[node])
      graph.add_tweights(node, source_[node] ? kUncuttableTerminal : 0, sink_[node] ? kUncuttableTerminal : 0);
  for_each_link(voxels_, places_, nodes_, [&](int p, bool p_shared, int q, bool q_shared) {
    graph.add_edge(p + p_shared, q, kUncuttable, 0);
    graph.add_edge(q + q_shared, p, kUncuttable, 0);
  });
  for (const auto& [sheets, votes] : ties_)
    if (votes > 0) graph.add_edge(sheets.first, sheets.second, 2 * kUnit * votes, 0);
  cost = double(graph.maxflow()) / kUnit;

  // The seam: entry reached from the source, exit not.
  reached_.resize(nodes_.count);
  for (int node = 0; node < nodes_.count; ++node)
    reached_[node] = graph.what_segment(node, FlowGraph::SINK) == FlowGraph::SOURCE;
  seam_.assign(nodes_.count, 0);
  for (int i = 0; i < n; ++i)
    if (const int node = nodes_.of_place[i]; places_.shared[i]) seam_[node] = reached_[node] && !reached_[node + 1];
  find_regions();
}

void RefinedCut::find_regions() {
  DisjointSets sets(nodes_.count);
  for_each_link(voxels_, places_, nodes_, [&](int p, bool, int q, bool) {
    if (!seam_[p] && !seam_[q]) sets.unite(p, q);
  });
  region_of_.resize(nodes_.count);
  for (int node = 0; node < nodes_.count; ++node) region_of_[node] = sets.find(node);
  regions_.assign(nodes_.count, {});
  for_each_link(voxels_, places_, nodes_, [&](int p, bool, int q, bool) {
    if (seam_[p] != seam_[q]) regions_[region_of_[seam_[p] ? q : p]].seam = true;
  });
  for (int i = 0; i < int(places_.cells.size()); ++i) {
    const int node = nodes_.of_place[i];
    if (seam_[node]) continue;
    Region& r = regions_[region_of_[node]];
    r.source |= reached_[node] != 0;
    r.sink |= sink_[node] || (places_.shared[i] && sink_[node + 1]);
    if (places_.shared[i])
      r.shared = true;
    else
      ++(of_a_[node] ? r.only_a : r.only_b);
  }
  for (std::size_t k = 0; k < voxels_.outer.size(); ++k) {
    const int node = nodes_.of_piece[k];
    Region& r = regions_[region_of_[node]];
    r.source |= reached_[node] != 0;
    r.sink |= sink_[node] != 0;
    ++(voxels_.outer[k].of_a ? r.only_a : r.only_b);
  }
}

/// Where surfaces cross, four sheets meet: of each model one outside the other
/// and one inside. What is kept must be both outer ones or both inner ones, or
/// one model whole: otherwise a border would face none, or the surface would
/// turn inside out across the seam. So keeping A's outer sheet asks to drop B's
/// inner one, and keeping B's outer sheet asks to drop A's inner one: arcs from
/// a sheet of A to one of B, which a minimal cut can honour.
void RefinedCut::tie_crossing_sheets(const std::vector<Eigen::Vector3f>& normal_a,
                                     const std::vector<Eigen::Vector3f>& normal_b) {
  const int reach = 3 + reach_;
  std::vector<std::array<int, 2>> sheets[2];  // (sheet, outside?) around a voxel, of B and of A
  for (std::size_t i = 0; i < places_.cells.size(); ++i) {
    const int v = places_.voxel[i];
    if (v < 0 || !voxels_.both(v)) continue;
    const std::array<int, 3> c = voxels_.grid.cell(places_.cells[i]);
    const Eigen::Vector3f normal[2] = {normal_a[v].normalized(), normal_b[v].normalized()};
    sheets[0].clear(), sheets[1].clear();
    for (int z = -reach; z <= reach; ++z)
      for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x) {
          if (!voxels_.grid.inside(c[0] + x, c[1] + y, c[2] + z)) continue;
          const int p = places_.set.node(voxels_.grid.index(c[0] + x, c[1] + y, c[2] + z));
          if (p < 0 || places_.shared[p]) continue;
          const bool of_a = of_a_[nodes_.of_place[p]];
          const float height = Eigen::Vector3f(float(x), float(y), float(z)).dot(normal[of_a]);
          if (std::abs(height) < 1) continue;  // about a voxel: neither side
          const std::array<int, 2> found{nodes_.of_place[p], height > 0};
          if (std::find(sheets[of_a].begin(), sheets[of_a].end(), found) == sheets[of_a].end())
            sheets[of_a].push_back(found);
        }
    for (const auto& a : sheets[1])
      for (const auto& b : sheets[0]) ties_[{a[0], b[0]}] += a[1] != b[1] ? 1 : -1;
  }
}

VoxelLabels RefinedCut::labels() const {
  VoxelLabels cut;
  cut.cost = cost;
  cut.connected = std::find(seam_.begin(), seam_.end(), 1) != seam_.end();
  cut.label.assign(voxels_.size(), VoxelLabels::kSeam);
  const auto decided = [](const Region& r) { return r.source || r.sink || r.seam; };
  std::vector<int> group(voxels_.size(), -1), group_of(nodes_.count, -1);
  int groups = 0;
  for (std::size_t i = 0; i < places_.cells.size(); ++i) {
    const int node = nodes_.of_place[i], v = places_.voxel[i];
    if (v < 0 || seam_[node]) continue;
    if (decided(region(node))) {
      cut.label[v] = region(node).label();
    } else {
      int& g = group_of[region_of_[node]];
      if (g < 0) g = groups++;
      group[v] = g;
    }
  }
  label_isolated(voxels_, group, groups, cut.label);
  for (std::size_t k = 0; k < voxels_.outer.size(); ++k) {
    const Region& r = region(nodes_.of_piece[k]);
    const bool of_a = voxels_.outer[k].of_a;
    cut.outer.push_back(decided(r) ? r.label() : std::int8_t(of_a ? VoxelLabels::kA : VoxelLabels::kB));
  }
  return cut;
}

}  // namespace

VoxelLabels refined_cut(const JointVoxels& voxels, const std::vector<Eigen::Vector3f>& normal_a,
                        const std::vector<Eigen::Vector3f>& normal_b, const RefinedOptions& options) {
  RefinedCut cut(voxels, normal_a, normal_b, options.reach);
  cut.solve();
  return cut.labels();
}

}  // namespace parts::cut
