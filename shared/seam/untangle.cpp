// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/untangle.h"

#include <algorithm>
#include <cmath>

#include "parts/cut/bits.h"
#include "parts/cut/grid.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/self_intersections.h"

namespace parts::seam {
namespace {

/// Calls visit(cell) for each cell of the grid that a face's box touches.
template <class Visit>
void for_each_cell(const cut::Grid& grid, const Box& box, const Visit& visit) {
  const Vec3 low = grid.to_grid(box.min()), high = grid.to_grid(box.max());
  int from[3], to[3];
  for (int d = 0; d < 3; ++d) {
    from[d] = int(std::clamp(std::floor(low[d]), 0.0, double(grid.dims[d] - 1)));
    to[d] = int(std::clamp(std::floor(high[d]), 0.0, double(grid.dims[d] - 1)));
  }
  for (int k = from[2]; k <= to[2]; ++k)
    for (int j = from[1]; j <= to[1]; ++j)
      for (int i = from[0]; i <= to[0]; ++i) visit(grid.index(i, j, k));
}

/// The faces near those that are asked about, as a mesh of their own.
class Neighbourhood {
 public:
  Neighbourhood(const Mesh& mesh, const std::vector<char>& asked) : mesh_(mesh), asked_(asked) {
    constexpr int kCells = 64;
    Box all;
    for (int f = 0; f < mesh.face_count(); ++f)
      if (asked[f]) all.extend(mesh.face_box(f));
    if (all.isEmpty() || !(all.sizes().maxCoeff() > 0)) return;
    const cut::Grid grid = cut::Grid::over(all, kCells);
    cut::VoxelSet cells(grid.count());
    for (int f = 0; f < mesh.face_count(); ++f)
      if (asked[f]) for_each_cell(grid, mesh.face_box(f), [&](std::size_t c) { cells.add(c); });
    std::vector<char> near(mesh.faces.size(), 0);
    for (int f = 0; f < mesh.face_count(); ++f) {
      const Box box = mesh.face_box(f);
      if (!all.intersects(box)) continue;
      for_each_cell(grid, box, [&](std::size_t c) { near[f] |= cells.has(c); });
      if (near[f]) faces_.push_back(f);
    }
  }

  /// Pairs of crossing faces, at least one of them asked about.
  /// @param limit  stop after about that many
  std::vector<std::array<int, 2>> crossings(long limit, int threads) const {
    Mesh local;
    local.vertices = mesh_.vertices;
    for (int f : faces_) local.faces.push_back(mesh_.faces[f]);
    std::vector<int> old_vertex;
    local = mesh::take_faces(local, std::vector<char>(faces_.size(), 1), &old_vertex);
    std::vector<std::array<int, 2>> pairs;
    for (const auto& [f, g] : mesh::intersecting_faces(local, limit, threads))
      if (asked_[faces_[f]] || asked_[faces_[g]]) pairs.push_back({faces_[f], faces_[g]});
    return pairs;
  }

 private:
  const Mesh& mesh_;
  const std::vector<char>& asked_;
  std::vector<int> faces_;
};

/// Pairs of faces that lie folded onto each other: what is left of a strip that ran back on itself. Its
/// faces are small; large ones that meet sharply are meant to.
std::vector<std::array<int, 2>> folded(const Mesh& mesh, const std::vector<std::array<int, 2>>& beside,
                                       double largest) {
  constexpr double kFolded = -0.34;  // the cosine between the normals: 110 degrees
  std::vector<std::array<int, 2>> folds;
  for (const auto& [f, g] : beside) {
    if (std::max(mesh.face_box(f).diagonal().norm(), mesh.face_box(g).diagonal().norm()) > largest) continue;
    const Vec3 a = mesh.area_vector(f), b = mesh.area_vector(g);
    if (a.dot(b) < kFolded * a.norm() * b.norm()) folds.push_back({f, g});
  }
  return folds;
}

/// What crossed or was folded already, away from the seam: it is the inputs' own. Sorted.
std::vector<std::array<int, 2>> flaws_before(Mesh& mesh, const std::vector<char>& asked,
                                             const std::vector<std::array<int, 2>>& beside, const Untangling& given,
                                             long limit) {
  const std::vector<Vec3> now = mesh.vertices;
  mesh.vertices = given.before;
  std::vector<std::array<int, 2>> own = Neighbourhood(mesh, asked).crossings(limit, given.threads);
  const std::vector<std::array<int, 2>> folds = folded(mesh, beside, given.largest_fold);
  mesh.vertices = now;
  own.insert(own.end(), folds.begin(), folds.end());
  const auto made = [&](const std::array<int, 2>& pair) {
    for (int f : pair)
      for (int v : mesh.faces[f])
        if (given.seam[v]) return true;
    return given.tag[pair[0]] != given.tag[pair[1]];
  };
  own.erase(std::remove_if(own.begin(), own.end(), made), own.end());
  std::sort(own.begin(), own.end());
  return own;
}

}  // namespace

std::vector<std::array<int, 2>> untangle(Mesh& mesh, const Untangling& given) {
  std::vector<char> asked(mesh.faces.size(), 0);
  std::vector<std::vector<int>> around(mesh.vertices.size());
  std::vector<char> free = given.movable;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f]) asked[f] |= given.movable[v];
  Mesh zone;
  zone.vertices.resize(mesh.vertices.size());
  std::vector<int> whole;  // per face of the zone
  for (int f = 0; f < mesh.face_count(); ++f)
    if (asked[f]) zone.faces.push_back(mesh.faces[f]), whole.push_back(f);
  std::vector<std::array<int, 2>> beside;
  mesh::for_each_mesh_edge(mesh::sorted_half_edges(zone), [&](auto first, auto last) {
    around[first->from].push_back(first->to), around[first->to].push_back(first->from);
    // The zone's own border runs along vertices that do not move anyway.
    if (last - first != 2)
      free[first->from] = free[first->to] = 0;
    else
      beside.push_back({whole[first->face], whole[first[1].face]});
  });

  // More pairs than that are no fold at a seam: relaxing a few vertices parts nothing, and takes for ever.
  const long hopeless = 1000 + 4 * std::count(asked.begin(), asked.end(), 1);
  const std::vector<std::array<int, 2>> own = flaws_before(mesh, asked, beside, given, hopeless);
  const auto drop_own = [&own](std::vector<std::array<int, 2>>& pairs) {
    const auto is_own = [&own](const auto& pair) { return std::binary_search(own.begin(), own.end(), pair); };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_own), pairs.end());
  };
  drop_own(beside);
  std::vector<Vec3> best;
  std::vector<std::array<int, 2>> left;
  std::pair<long, std::size_t> least(-1, 0);  // crossings, folds
  for (int round = 0;; ++round) {
    std::vector<std::array<int, 2>> pairs =
        Neighbourhood(mesh, asked).crossings(hopeless + long(own.size()), given.threads);
    drop_own(pairs);
    const long crossings = std::min(long(pairs.size()), hopeless);
    const std::vector<std::array<int, 2>> folds = folded(mesh, beside, given.largest_fold);
    const std::pair<long, std::size_t> flaws(crossings, folds.size());
    if (least.first < 0 || flaws < least) least = flaws, best = mesh.vertices, left = pairs;
    pairs.insert(pairs.end(), folds.begin(), folds.end());
    if (pairs.empty() || round == given.rounds || crossings == hopeless) break;
    std::vector<char> moving(mesh.vertices.size(), 0);
    for (const auto& pair : pairs)
      for (int f : pair)
        for (int v : mesh.faces[f]) moving[v] = 1;
    for (int ring = 0; ring < round / 3; ++ring) {
      const std::vector<char> inner = moving;
      for (std::size_t v = 0; v < inner.size(); ++v)
        if (inner[v])
          for (int u : around[v]) moving[u] = 1;
    }
    std::vector<std::pair<int, Vec3>> to;
    for (int step = 0; step < 3; ++step) {
      to.clear();
      for (int v = 0; v < mesh.vertex_count(); ++v) {
        if (!moving[v] || !free[v] || around[v].empty()) continue;
        Vec3 mean = Vec3::Zero();
        for (int u : around[v]) mean += mesh.vertices[u];
        to.emplace_back(v, 0.5 * mesh.vertices[v] + 0.5 / double(around[v].size()) * mean);
      }
      for (const auto& [v, p] : to) mesh.vertices[v] = p;
    }
  }
  mesh.vertices = best;
  return left;
}

}  // namespace parts::seam
