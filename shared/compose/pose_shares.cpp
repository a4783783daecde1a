// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <queue>

#include "parts/compose/rigid_cut.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/prepare.h"

namespace parts::compose {
namespace {

/// A mesh's edges with cotangent weights, and the vertices' areas.
struct Laplacian {
  struct Neighbour {
    int vertex;
    double weight, length;
  };
  std::vector<std::vector<Neighbour>> around;
  std::vector<double> area;

  /// @param vertex  per vertex of the mesh: the first at its place
  Laplacian(const Mesh& mesh, const std::vector<int>& vertex)
      : around(mesh.vertices.size()), area(mesh.vertices.size(), 0) {
    for (int f = 0; f < mesh.face_count(); ++f)
      for (int k = 0; k < 3; ++k) {
        const int i = vertex[mesh.faces[f][k]], j = vertex[mesh.faces[f][(k + 1) % 3]],
                  o = vertex[mesh.faces[f][(k + 2) % 3]];
        area[i] += mesh.area(f) / 3;
        if (i == j || !mesh.vertices[i].allFinite() || !mesh.vertices[j].allFinite()) continue;
        const Vec3 p = mesh.vertices[i] - mesh.vertices[o], q = mesh.vertices[j] - mesh.vertices[o];
        const double cross = p.cross(q).norm();
        // Needles must not decide.
        const double weight = 0.5 * std::clamp(cross > 0 ? p.dot(q) / cross : 0.0, 0.05, 5.0);
        const double length = (mesh.vertices[i] - mesh.vertices[j]).norm();
        around[i].push_back({j, weight, length}), around[j].push_back({i, weight, length});
      }
  }
};

/// Vertices within a distance of the seam along edges.
std::vector<int> band(const Laplacian& mesh, const std::vector<std::array<int, 2>>& seam, double distance) {
  std::vector<double> away(mesh.around.size(), 1e300);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const auto& edge : seam)
    for (int v : edge) queue.push({away[v] = 0, v});
  std::vector<int> found;
  std::vector<char> done(mesh.around.size(), 0);
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (done[v]) continue;
    done[v] = 1, found.push_back(v);
    for (const auto& n : mesh.around[v])
      if (d + n.length < away[n.vertex] && d + n.length <= distance)
        queue.push({away[n.vertex] = d + n.length, n.vertex});
  }
  return found;
}

}  // namespace

std::vector<double> pose_shares(const Mesh& mesh, const RigidCut& cut, const std::vector<char>& fixed,
                                const std::vector<char>& moving, double distance) {
  const std::vector<int> first = mesh::first_at_same_place(mesh);
  std::vector<double> share(mesh.vertices.size(), 0);
  std::vector<char> known(mesh.vertices.size(), 0);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f]) share[first[v]] = std::max<double>(share[first[v]], cut.moves[f]);
  for (int f = 0; f < mesh.face_count(); ++f)
    if (fixed[f] || moving[f])
      for (int v : mesh.faces[f]) share[first[v]] = moving[f], known[first[v]] = 1;

  const Laplacian laplacian(mesh, first);
  std::vector<int> unknowns;
  std::vector<int> number(mesh.vertices.size(), -1);
  for (int v : band(laplacian, cut.seam, distance))
    if (!known[v]) number[v] = int(unknowns.size()), unknowns.push_back(v);
  // Least squares of the Laplacian over the band and its rim: rows of L scaled by 1 / sqrt(area).
  std::vector<int> row_of(mesh.vertices.size(), -1), rows;
  for (int v : unknowns) {
    if (row_of[v] < 0) row_of[v] = int(rows.size()), rows.push_back(v);
    for (const auto& n : laplacian.around[v])
      if (row_of[n.vertex] < 0) row_of[n.vertex] = int(rows.size()), rows.push_back(n.vertex);
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(long(rows.size()));
  for (int r = 0; r < int(rows.size()); ++r) {
    const int v = rows[r];
    const double scale = 1 / std::sqrt(std::max(laplacian.area[v], 1e-300));
    const auto add = [&](int vertex, double weight) {
      if (number[vertex] >= 0)
        entries.emplace_back(r, number[vertex], weight * scale);
      else
        right[r] -= weight * scale * share[vertex];
    };
    for (const auto& n : laplacian.around[v]) add(v, n.weight), add(n.vertex, -n.weight);
  }
  if (!unknowns.empty()) {
    Eigen::SparseMatrix<double> l(long(rows.size()), long(unknowns.size()));
    l.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(l.transpose() * l);
    if (solver.info() == Eigen::Success) {
      const Eigen::VectorXd solved = solver.solve(l.transpose() * right);
      for (std::size_t i = 0; i < unknowns.size(); ++i)
        if (std::isfinite(solved[long(i)])) share[unknowns[i]] = std::clamp(solved[long(i)], 0.0, 1.0);
    }
  }
  for (std::size_t v = 0; v < share.size(); ++v) share[v] = share[first[v]];
  return share;
}

}  // namespace parts::compose
