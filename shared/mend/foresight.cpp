// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/foresight.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "parts/mesh/attributes.h"
#include "parts/mesh/laplacian.h"
#include "parts/spatial/closest_face.h"

namespace parts::mend {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kBand = 0.25;  // of the region's size
constexpr int kRounds = 3;      // the first as a graph, then with the angles found

/// The Laplacian of the mesh as a graph: it knows nothing of the places.
mesh::Laplacian graph_laplacian(const Mesh& mesh) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const Triangle& f : mesh.faces)
    for (int k = 0; k < 3; ++k)
      for (const auto& [u, v] : {std::array<int, 2>{f[k], f[(k + 1) % 3]}, std::array<int, 2>{f[(k + 1) % 3], f[k]}})
        entries.emplace_back(u, u, 0.5), entries.emplace_back(u, v, -0.5);
  mesh::Laplacian l;
  l.matrix.resize(mesh.vertex_count(), mesh.vertex_count());
  l.matrix.setFromTriplets(entries.begin(), entries.end());
  l.area = Eigen::VectorXd::Ones(mesh.vertex_count());
  return l;
}

/// Least |laplacian|^2 over the free vertices.
bool solve(const mesh::Laplacian& l, const std::vector<char>& free, std::vector<Vec3>& points) {
  std::vector<int> row(points.size(), -1);
  int n = 0;
  for (std::size_t v = 0; v < row.size(); ++v)
    if (free[v]) row[v] = n++;
  std::vector<Eigen::Triplet<double>> pick;
  Eigen::MatrixXd fixed = Eigen::MatrixXd::Zero(long(points.size()), 3);
  for (std::size_t v = 0; v < row.size(); ++v) {
    if (row[v] >= 0)
      pick.emplace_back(int(v), row[v], 1);
    else
      fixed.row(long(v)) = points[v].transpose();
  }
  Sparse select(long(points.size()), n);
  select.setFromTriplets(pick.begin(), pick.end());
  const double least = 1e-9 * l.area.maxCoeff();
  const Sparse weighted = l.area.cwiseMax(least).cwiseInverse().asDiagonal() * l.matrix;
  const Sparse bending = l.matrix.transpose() * weighted;
  const Sparse system = select.transpose() * bending * select;
  const Eigen::SimplicialLDLT<Sparse> solver(system);
  if (solver.info() != Eigen::Success) return false;
  const Eigen::MatrixXd x = solver.solve(-(select.transpose() * (bending * fixed)));
  if (!x.allFinite()) return false;
  for (std::size_t v = 0; v < row.size(); ++v)
    if (row[v] >= 0) points[v] = x.row(row[v]).transpose();
  return true;
}

/// Vertices of sound surface beside a patch, reached along the surface.
/// @param reach  how far from the patch's border, world units
std::vector<char> band_beside(const Mesh& mesh, const std::vector<int>& source, double reach) {
  std::vector<char> patch(mesh.vertices.size(), 0), scan = patch, band = patch;
  Mesh rim;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f]) (source[f] < 0 ? patch : scan)[v] = 1;
  std::vector<char> beside(mesh.faces.size());
  for (int f = 0; f < mesh.face_count(); ++f)
    beside[f] =
        source[f] >= 0 && std::any_of(mesh.faces[f].begin(), mesh.faces[f].end(), [&](int v) { return patch[v] != 0; });
  const spatial::ClosestFace at_rim(mesh, beside);
  if (at_rim.empty()) return band;
  std::vector<char> near(mesh.vertices.size(), 0);
  int hint = 0;
  for (int v = 0; v < mesh.vertex_count(); ++v) near[v] = scan[v] && at_rim(mesh.vertices[v], hint).distance < reach;
  for (int v = 0; v < mesh.vertex_count(); ++v) band[v] = patch[v] && scan[v];
  for (bool grown = true; grown;) {
    grown = false;
    for (int f = 0; f < mesh.face_count(); ++f) {
      if (source[f] < 0) continue;
      const Triangle& t = mesh.faces[f];
      if (!band[t[0]] && !band[t[1]] && !band[t[2]]) continue;
      for (int v : t)
        if (near[v] && !band[v]) band[v] = 1, grown = true;
    }
  }
  return band;
}

double rms_to(const Mesh& surface, const std::vector<Vec3>& points) {
  const spatial::ClosestFace closest(surface);
  if (closest.empty() || points.empty()) return INFINITY;
  double sum = 0;
  int hint = 0;
  for (const Vec3& p : points) sum += std::pow(closest(p, hint).distance, 2);
  return std::sqrt(sum / double(points.size()));
}

}  // namespace

std::vector<Vec3> faired(const Mesh& mesh, const std::vector<char>& free) {
  // What is free, and two rings around it.
  std::vector<char> near = free, in(mesh.faces.size(), 0);
  for (int ring = 0; ring < 3; ++ring) {
    const std::vector<char> before = near;
    for (int f = 0; f < mesh.face_count(); ++f) {
      const Triangle& t = mesh.faces[f];
      if (!before[t[0]] && !before[t[1]] && !before[t[2]]) continue;
      in[f] = 1, near[t[0]] = near[t[1]] = near[t[2]] = 1;
    }
  }
  std::vector<int> old_vertex;
  Mesh part = mesh::take_faces(mesh, in, &old_vertex);
  std::vector<char> moves;
  for (int v : old_vertex) moves.push_back(free[v]);
  for (int round = 0; round < kRounds; ++round)
    if (!solve(round == 0 ? graph_laplacian(part) : mesh::laplacian(part.vertices, part.faces), moves, part.vertices))
      break;
  std::vector<Vec3> out = mesh.vertices;
  for (std::size_t v = 0; v < old_vertex.size(); ++v) out[old_vertex[v]] = part.vertices[v];
  return out;
}

Foresight foresee(const Scan& scan, const Region& region, const Restored& restored, const PlacedModel& model,
                  const FittingOptions& options, Progress& progress) {
  const Mesh& mesh = restored.mesh;
  std::vector<char> band = band_beside(mesh, restored.source, kBand * region.size()), free = band;
  std::vector<Vec3> truth;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (band[v]) truth.push_back(mesh.vertices[v]);
  for (int f = 0; f < mesh.face_count(); ++f)
    if (restored.source[f] < 0)
      for (int v : mesh.faces[f]) free[v] = 1;
  Foresight sight;
  Mesh fair = mesh;
  fair.vertices = faired(mesh, free);
  sight.fair = rms_to(fair, truth);

  std::vector<char> hidden(scan.mesh().faces.size(), 1);
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (restored.source[f] < 0) continue;
    const Triangle& t = mesh.faces[f];
    hidden[restored.source[f]] = band[t[0]] || band[t[1]] || band[t[2]];
  }
  FittingOptions alone = options;
  alone.blend = 1;
  const FitTarget target(scan.mesh(), hidden, around(region, 2 * kAround), region.size());
  const std::vector<PlacedModel> models{model};
  sight.model = rms_to(ModelFitter(models, region, target, alone)(0, progress).mesh, truth);
  return sight;
}

}  // namespace parts::mend
