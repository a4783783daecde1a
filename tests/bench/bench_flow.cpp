// SPDX-License-Identifier: GPL-3.0-or-later
// The thesis' cut (eq. 1-2) on the surface voxels alone, against two max-flow
// libraries on the full grid with the same capacities. `--full`: at 128³, as
// well as 64³ (the slowest contender takes minutes).

#include <cstring>
#include <opencv2/imgproc.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>

#include "bench/measure.h"
#include "bench/scenes.h"
#include "parts/cut/labels.h"
#include "parts/cut/max_flow.h"
#include "parts/cut/rasterize.h"

using namespace parts;
using namespace parts::bench;

namespace {

cut::JointVoxels rasterized(const Scene& s, const cut::Grid& grid) {
  return cut::join(grid, cut::rasterize(s.a.mesh, {}, grid, 1), cut::rasterize(s.b.mesh, {}, grid, 1),
                   cut::rasterize(s.a.mesh, s.a.keep, grid, 1), cut::rasterize(s.b.mesh, s.b.keep, grid, 1));
}

/// Equations 1 and 2 as integers: every weight times 100 n k.
struct Capacities {
  std::int64_t boundary, intersection, empty;
  explicit Capacities(const cut::JointVoxels& v) {
    std::int64_t n = std::int64_t(v.grid.count()), k = 1;
    for (int p = 0; p < v.size(); ++p) k += v.both(p);
    boundary = 100 * n * k, intersection = 10 * n, empty = 1;
  }
  std::int64_t of_voxel(const cut::JointVoxels& v, std::size_t voxel) const {
    const int p = v.set.node(voxel);
    return p < 0 ? empty : v.both(p) ? intersection : boundary;
  }
};

/// Calls visit(voxel, voxel, capacity) for every edge of the full grid.
template <class Visit>
void for_each_grid_edge(const cut::JointVoxels& v, const Visit& visit) {
  const cut::Grid& g = v.grid;
  const Capacities capacities(v);
  for (std::size_t p = 0; p < g.count(); ++p) {
    const std::array<int, 3> c = g.cell(p);
    const std::size_t step[3] = {1, std::size_t(g.dims[0]), std::size_t(g.dims[0]) * g.dims[1]};
    for (int d = 0; d < 3; ++d)
      if (c[d] + 1 < g.dims[d])
        visit(int(p), int(p + step[d]), std::min(capacities.of_voxel(v, p), capacities.of_voxel(v, p + step[d])));
  }
}

using Labels = std::vector<char>;  // per surface voxel: on A's side

Labels ours(const cut::JointVoxels& v) {
  const cut::VoxelLabels cut = cut::thesis_cut(v);
  Labels labels;
  for (std::int8_t l : cut.label) labels.push_back(l == cut::VoxelLabels::kA);
  return labels;
}

Labels with_maxflow(const cut::JointVoxels& v) {
  using Graph = maxflow::Graph<std::int64_t, std::int64_t, std::int64_t>;
  const int n = int(v.grid.count());
  Graph graph(n, 3 * n);
  graph.add_node(n);
  for_each_grid_edge(v, [&](int p, int q, std::int64_t w) { graph.add_edge(p, q, w, w); });
  for (int p = 0; p < v.size(); ++p)
    if (v.flags[p] & (cut::kKeepA | cut::kKeepB))
      graph.add_tweights(int(v.cells[p]), v.flags[p] & cut::kKeepA ? cut::kUncuttableTerminal : 0,
                         v.flags[p] & cut::kKeepB ? cut::kUncuttableTerminal : 0);
  graph.maxflow();
  Labels labels;
  for (std::size_t c : v.cells) labels.push_back(graph.what_segment(int(c), Graph::SINK) == Graph::SOURCE);
  return labels;
}

Labels with_opencv(const cut::JointVoxels& v) {
  const int n = int(v.grid.count());
  cv::detail::GCGraph<std::int64_t> graph(n, 6 * n);
  for (int p = 0; p < n; ++p) graph.addVtx();
  for_each_grid_edge(v, [&](int p, int q, std::int64_t w) { graph.addEdges(p, q, w, w); });
  for (int p = 0; p < v.size(); ++p)
    if (v.flags[p] & (cut::kKeepA | cut::kKeepB))
      graph.addTermWeights(int(v.cells[p]), v.flags[p] & cut::kKeepA ? cut::kUncuttableTerminal : 0,
                           v.flags[p] & cut::kKeepB ? cut::kUncuttableTerminal : 0);
  graph.maxFlow();
  Labels labels;
  for (std::size_t c : v.cells) labels.push_back(graph.inSourceSegment(int(c)));
  return labels;
}

/// Processor seconds, boundary and intersection edges that the labels cut.
std::vector<double> solve(const Scene& scene, const cut::Grid& grid, Labels (*solver)(const cut::JointVoxels&)) {
  const cut::JointVoxels v = rasterized(scene, grid);
  Labels labels;
  const Times t = best_of([&] { labels = solver(v); });
  double boundary = 0, intersection = 0;
  cut::for_each_edge(grid, v.set, v.cells, [&](int p, int q) {
    if (labels[p] != labels[q]) ++(v.both(p) || v.both(q) ? intersection : boundary);
  });
  return {t.cpu, boundary, intersection};
}

void compare(Table& table, const Scene& scene, int size) {
  const cut::Grid grid = cut::Grid::over(bounds(scene.a, scene.b), size - 2);
  const std::string name = scene.name + " " + std::to_string(grid.dims[0]) + "×" + std::to_string(grid.dims[1]) + "×" +
                           std::to_string(grid.dims[2]);
  Child first;
  const auto row = [&](const char* contender, Labels (*solver)(const cut::JointVoxels&), double faster,
                       double smaller) {
    const Child c = in_child([&] { return solve(scene, grid, solver); }, 3000);
    if (!c.ended) return table.row({name, contender, "failed, or more than 3000 s"});
    const bool us = faster == 0;
    if (us) first = c;
    const double time = c.figures[0] / first.figures[0], memory = c.grown / first.grown;
    const bool same = c.figures[1] == first.figures[1] && c.figures[2] == first.figures[2];
    std::string target;
    if (!us) target = "≥ " + ratio(faster) + ": " + verdict(time >= faster);
    if (smaller > 0) target += ", memory ≥ " + ratio(smaller) + ": " + verdict(memory >= smaller);
    table.row({name, contender, text(c.figures[0]), us ? "" : ratio(time), megabytes(c.grown), us ? "" : ratio(memory),
               std::to_string(long(c.figures[1])) + ", " + std::to_string(long(c.figures[2])), us ? "" : verdict(same),
               target});
  };
  row("surface voxels (ours)", ours, 0, 0);
  row("libmaxflow, full grid", with_maxflow, 20, 0);
  row("OpenCV GCGraph, full grid", with_opencv, 500, 10);
}

}  // namespace

int main(int argc, char** argv) {
  const bool full = argc > 1 && std::strcmp(argv[1], "--full") == 0;
  const std::vector<int> sizes = full ? std::vector<int>{64, 128} : std::vector<int>{64};
  for (int size : sizes) {
    Table table("The thesis' graph and capacities (eq. 1-2), " + std::to_string(size) + "³",
                {"Scene", "Solver", "Processor s", "Ours is faster by", "Memory", "Theirs / ours",
                 "Boundary, intersection edges cut", "Same cost as ours", "Target (set for 128³)"});
    for (Scene scene : {two_spheres(20000), two_tori(20000)}) {
      fit(scene, Vec3::Constant(1));
      compare(table, scene, size);
    }
    table.note("Time: building the graph, maximal flow and labels, of voxels that are there. Memory: the growth of");
    table.note("a process of its own from before the rasterisation to its highest.");
  }
  if (!full) std::printf("\n'./run bench flow --full' compares at 128³ too; it takes up to ten minutes.\n");
}
