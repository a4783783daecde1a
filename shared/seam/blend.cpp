// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/blend.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "parts/mesh/edges.h"
#include "parts/mesh/laplacian.h"
#include "parts/seam/band.h"

namespace parts::seam {
namespace {

constexpr double kDegrees = 180 / M_PI;

/// Degrees between the faces at edges that lie in the seam.
std::vector<double> seam_angles(const Mesh& mesh, const std::vector<char>& seam) {
  Mesh near;
  near.vertices = mesh.vertices;
  for (const Triangle& f : mesh.faces)
    if ((seam[f[0]] != 0) + (seam[f[1]] != 0) + (seam[f[2]] != 0) >= 2) near.faces.push_back(f);
  std::vector<double> angles;
  mesh::for_each_mesh_edge(mesh::sorted_half_edges(near), [&](auto first, auto last) {
    if (last - first != 2 || !seam[first->from] || !seam[first->to]) return;
    const Vec3 m = near.area_vector(first->face), n = near.area_vector(first[1].face);
    if (m.norm() > 0 && n.norm() > 0) angles.push_back(std::atan2(m.cross(n).norm(), m.dot(n)) * kDegrees);
  });
  return angles;
}

double share(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  const auto at = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double mean_edge(const Mesh& mesh, const std::function<bool(const Triangle&)>& pass) {
  double sum = 0;
  long count = 0;
  for (const Triangle& f : mesh.faces)
    if (pass(f))
      for (int k = 0; k < 3; ++k) sum += (mesh.vertices[f[k]] - mesh.vertices[f[(k + 1) % 3]]).norm(), ++count;
  return count ? sum / double(count) : 0;
}

/// Of the surfaces beside the seam: of faces next to those at it.
double mean_edge_beside(const Mesh& mesh, const std::vector<char>& seam) {
  std::vector<char> near = seam;
  for (int ring = 0; ring < 3; ++ring) {
    std::vector<char> wider = near;
    for (const Triangle& f : mesh.faces)
      if (near[f[0]] || near[f[1]] || near[f[2]])
        for (int v : f) wider[v] = 1;
    near.swap(wider);
  }
  return mean_edge(mesh, [&](const Triangle& f) {
    return near[f[0]] && near[f[1]] && near[f[2]] && !seam[f[0]] && !seam[f[1]] && !seam[f[2]];
  });
}

/// So wide that an edge takes up 3 degrees of what the seam bends in the median,
/// 10 where it bends most, and of the step that it was; within limits, as a fillet
/// as large as the models is no seam.
/// @param beside  the mean edge beside the seam. The cut split the faces that it
///                met: of edges that are longer elsewhere, up to four times that counts.
double natural_distance(const Mesh& mesh, const std::vector<double>& angles, double beside, double gap) {
  constexpr double kUsual = 6, kMost = 20;                    // degrees an edge of the distance, on both sides
  constexpr double kNarrow = 4, kWide = 12, kLargest = 0.06;  // of the models' size
  if (!(beside > 0)) return 0;
  const double edge = std::clamp(mean_edge(mesh, [](const Triangle&) { return true; }), beside, 4 * beside);
  const double size = mesh.bounds().diagonal().norm();
  const double edges = std::max({share(angles, 0.5) / kUsual, share(angles, 0.95) / kMost, std::sqrt(30 * gap / edge)});
  return std::max(kNarrow * edge, std::min(kLargest * size, edge * std::min(edges, kWide)));
}

/// The part of the surface that gives way, as a system of its own.
class Membrane {
 public:
  Membrane(const Mesh& mesh, const std::vector<char>& seam, const std::vector<char>& fixed, double distance);
  /// The offsets of its free vertices; none if the system cannot be solved.
  std::vector<Vec3> solve() const;
  const std::vector<int>& free() const { return free_; }

 private:
  void number(const Band& band, double distance, const std::vector<char>& fixed);
  Vec3 normal_at(int i) const;
  Eigen::MatrixX3d missing_bend(const Eigen::MatrixX3d& bend, const Eigen::VectorXd& area) const;

  const Mesh& mesh_;
  std::vector<int> free_;   ///< vertices of the mesh, in order
  std::vector<int> local_;  ///< vertices of the mesh that a face of the part has, the free ones first
  std::vector<Triangle> faces_;
  std::vector<Vec3> normals_;             ///< per local vertex: its faces', twice their areas long
  std::vector<char> creased_, border_;    ///< per local vertex
  std::vector<std::vector<int>> around_;  ///< per local vertex that is creased
};

Membrane::Membrane(const Mesh& mesh, const std::vector<char>& seam, const std::vector<char>& fixed, double distance)
    : mesh_(mesh) {
  const Band band = band_around(mesh, seam, distance);
  number(band, distance, fixed);
  std::vector<int> number_of(mesh.vertices.size(), -1);
  for (std::size_t i = 0; i < local_.size(); ++i) number_of[local_[i]] = int(i);
  creased_.assign(local_.size(), 0), border_.assign(local_.size(), 0), around_.resize(local_.size());
  normals_.assign(local_.size(), Vec3::Zero());
  // The seam and what is next to it: its place was settled when the borders
  // became one, so neither its bend nor its neighbours' is any detail.
  for (int v : band.vertices) {
    const int i = number_of[v];
    if (i >= 0) border_[i] = band.on_border[v];
    if (!seam[v]) continue;
    if (i >= 0) creased_[i] = 1;
    for (int u : band.around[v])
      if (number_of[u] >= 0) creased_[number_of[u]] = 1;
  }
  for (std::size_t i = 0; i < local_.size(); ++i)
    if (creased_[i])
      for (int u : band.around[local_[i]])
        if (number_of[u] >= 0) around_[i].push_back(number_of[u]);
  for (const Triangle& f : mesh.faces) {
    const Triangle t{number_of[f[0]], number_of[f[1]], number_of[f[2]]};
    if (t[0] < 0 || t[1] < 0 || t[2] < 0) continue;
    faces_.push_back(t);
    for (int k = 0; k < 3; ++k)
      normals_[t[k]] += (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]);
  }
}

/// Numbers the free vertices, then those two edges around them: as far as
/// offsets and creases have a say.
void Membrane::number(const Band& band, double distance, const std::vector<char>& fixed) {
  std::vector<char> taken(mesh_.vertices.size(), 0);
  for (int v : band.vertices)
    if (band.away[v] < distance && !fixed[v]) free_.push_back(v), taken[v] = 1;
  std::sort(free_.begin(), free_.end());
  local_ = free_;
  for (int v : band.vertices)
    if (!taken[v]) local_.push_back(v), taken[v] = 1;
  for (int ring = 0; ring < 2; ++ring) {
    std::vector<char> next = taken;
    for (const Triangle& f : mesh_.faces)
      if (taken[f[0]] || taken[f[1]] || taken[f[2]])
        for (int v : f)
          if (!next[v]) next[v] = 1, local_.push_back(v);
    taken.swap(next);
  }
}

/// Where the surface faces around a local vertex, on both sides of the seam.
Vec3 Membrane::normal_at(int i) const {
  Vec3 sum = normals_[i];
  for (int u : around_[i]) sum += normals_[u];
  return sum.normalized();
}

/// What the Laplacian of the positions lacks where the surface is creased: what
/// lies around the crease goes on into it; along a border that the seam runs out
/// to, what lies along the border.
Eigen::MatrixX3d Membrane::missing_bend(const Eigen::MatrixX3d& bend, const Eigen::VectorXd& area) const {
  const int n = int(local_.size());
  Eigen::MatrixX3d curvature = area.cwiseInverse().asDiagonal() * bend;
  for (int i = 0; i < n; ++i)
    if (creased_[i]) curvature.row(i).setZero();
  constexpr int kSweeps = 40;  // for a strip of a few vertices
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int i = 0; i < n; ++i) {
      if (!creased_[i]) continue;
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      int count = 0;
      for (int u : around_[i])
        if (border_[u] == border_[i]) sum += curvature.row(u), ++count;
      if (count) curvature.row(i) = sum / count;
    }
  Eigen::MatrixX3d missing = Eigen::MatrixX3d::Zero(n, 3);
  for (int i = 0; i < n; ++i) {
    if (!creased_[i]) continue;
    // Along the surface it would only drag uneven triangles about.
    const Vec3 normal = normal_at(i);
    missing.row(i) = normal.dot(area[i] * curvature.row(i).transpose() - bend.row(i).transpose()) * normal.transpose();
  }
  return missing;
}

/// Least squares, weighted by area: the Laplacian of the offsets is to be what
/// is missing at the crease and nothing elsewhere.
std::vector<Vec3> Membrane::solve() const {
  const int n = int(local_.size()), m = int(free_.size());
  if (m == 0) return {};
  std::vector<Vec3> points;
  for (int v : local_) points.push_back(mesh_.vertices[v]);
  const mesh::Laplacian l = mesh::laplacian(points, faces_);
  constexpr double kLeastArea = 0.05;  // of the mean
  const Eigen::VectorXd area = (l.area / std::max(l.area.head(m).mean(), 1e-300)).cwiseMax(kLeastArea);
  Eigen::MatrixX3d x(n, 3);
  for (int i = 0; i < n; ++i) x.row(i) = points[i].transpose();
  const Eigen::VectorXd weight = area.cwiseInverse();
  const Eigen::MatrixX3d missing = missing_bend(l.matrix * x, area);

  const Eigen::SparseMatrix<double> columns = l.matrix.leftCols(m);
  Eigen::SparseMatrix<double> system = columns.transpose() * weight.asDiagonal() * columns;
  // Where nothing holds a whole model, this does.
  constexpr double kHold = 1e-9;
  for (int i = 0; i < m; ++i) system.coeffRef(i, i) *= 1 + kHold;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky(system);
  if (cholesky.info() != Eigen::Success) return {};
  const Eigen::MatrixX3d offset = cholesky.solve(columns.transpose() * (weight.asDiagonal() * missing));
  if (cholesky.info() != Eigen::Success || !offset.allFinite()) return {};
  std::vector<Vec3> offsets;
  for (int i = 0; i < m; ++i) offsets.push_back(offset.row(i).transpose());
  return offsets;
}

/// Faces that a movement turns over, without those that have no side anyway.
long turned_over(const Mesh& before, const std::vector<Vec3>& after, const std::vector<char>& moved) {
  long count = 0;
  for (int f = 0; f < before.face_count(); ++f) {
    const Triangle& t = before.faces[f];
    if (!moved[t[0]] && !moved[t[1]] && !moved[t[2]]) continue;
    const Vec3 was = before.area_vector(f), is = (after[t[1]] - after[t[0]]).cross(after[t[2]] - after[t[0]]);
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (before.corner(f, k) - before.corner(f, (k + 1) % 3)).squaredNorm());
    count += was.norm() > 0.05 * longest && was.dot(is) <= 0;
  }
  return count;
}

}  // namespace

namespace {

/// The surface around a seam, as far as blending has to know it.
struct Neighbourhood {
  Mesh mesh;
  std::vector<int> vertex;        ///< per vertex: its number in the whole
  std::vector<char> seam, fixed;  ///< per vertex; beyond the distance all are fixed
  double reach;                   ///< world units; all that may move lies within, even when it has moved

  Neighbourhood(const Mesh& whole, const std::vector<char>& all_seam, const std::vector<char>& all_fixed,
                double distance)
      : reach(2 * distance) {
    const Band band = band_around(whole, all_seam, reach);
    std::vector<int> number(whole.vertices.size(), -1);
    const auto take = [&](int v) {
      if (number[v] >= 0) return;
      number[v] = int(vertex.size());
      vertex.push_back(v), mesh.vertices.push_back(whole.vertices[v]);
      seam.push_back(all_seam[v]), fixed.push_back(all_fixed[v] || !(band.away[v] < distance));
    };
    for (const Triangle& f : whole.faces) {
      if (band.away[f[0]] == Band::kBeyond && band.away[f[1]] == Band::kBeyond && band.away[f[2]] == Band::kBeyond)
        continue;
      for (int v : f) take(v);
      mesh.faces.push_back({number[f[0]], number[f[1]], number[f[2]]});
    }
  }
};

/// Adds as much of the offsets as does not fold the surface, or folds it least.
void give_way(Mesh& mesh, const std::vector<int>& free, const std::vector<Vec3>& offsets) {
  std::vector<char> moved(mesh.vertices.size(), 0);
  for (int v : free) moved[v] = 1;
  std::vector<Vec3> best;
  long least = -1;
  for (const double part : {1.0, 0.7, 0.4}) {
    std::vector<Vec3> to = mesh.vertices;
    for (std::size_t i = 0; i < offsets.size(); ++i) to[free[i]] += part * offsets[i];
    const long over = turned_over(mesh, to, moved);
    if (least < 0 || over < least) least = over, best = std::move(to);
    if (least == 0) break;
  }
  mesh.vertices = std::move(best);
}

/// Bends the neighbourhood until its seam hardly gets any flatter.
/// @return the vertices that went too far, if any did
std::vector<int> give_way_in_rounds(Neighbourhood& near, const std::vector<Vec3>& given, double farthest,
                                    SeamBlend& report) {
  // A sharp crease is no small one: its normals are not known before it is flatter.
  constexpr int kRounds = 6;
  constexpr double kLittle = 0.9;
  for (int round = 0; round < kRounds; ++round) {
    const Membrane membrane(near.mesh, near.seam, near.fixed, near.reach);
    const std::vector<Vec3> offsets = membrane.solve();
    if (offsets.empty()) break;
    const std::vector<Vec3> before = near.mesh.vertices;
    give_way(near.mesh, membrane.free(), offsets);
    const double after = share(seam_angles(near.mesh, near.seam), 0.5);
    std::vector<int> far;
    for (int v = 0; v < near.mesh.vertex_count(); ++v)
      if ((near.mesh.vertices[v] - given[v]).norm() > farthest) far.push_back(v);
    if (!far.empty()) return far;
    if (round > 0 && after > report.angle_after) {
      near.mesh.vertices = before;
      break;
    }
    const bool enough = round > 0 && after > kLittle * report.angle_after;
    report.moved = int(offsets.size()), report.angle_after = after;
    if (enough) break;
  }
  return {};
}

/// Fixes vertices and those next to them. @return false if that is more than half of the seam
bool hold(Neighbourhood& near, const std::vector<int>& vertices) {
  std::vector<char> at(near.mesh.vertices.size(), 0);
  for (int v : vertices) at[v] = 1;
  for (const Triangle& f : near.mesh.faces)
    if (at[f[0]] == 1 || at[f[1]] == 1 || at[f[2]] == 1)
      for (int v : f)
        if (!at[v]) at[v] = 2;
  long seam = 0, held = 0;
  for (std::size_t v = 0; v < at.size(); ++v) {
    near.fixed[v] |= at[v] != 0;
    seam += near.seam[v] != 0, held += near.seam[v] && near.fixed[v];
  }
  return 2 * held <= seam;
}

}  // namespace

SeamBlend blend_seam(Mesh& mesh, const std::vector<char>& seam, const std::vector<char>& fixed, double distance,
                     double gap) {
  SeamBlend report;
  const std::vector<double> angles = seam_angles(mesh, seam);
  report.angle_before = report.angle_after = share(angles, 0.5);
  const double edge = mean_edge_beside(mesh, seam);
  report.distance = distance > 0 ? distance : natural_distance(mesh, angles, edge, gap);
  if (!(report.distance >= edge) || edge == 0) return report;
  constexpr std::size_t kMost = 100000;  // vertices; bounds time and memory
  if (const Band band = band_around(mesh, seam, report.distance); band.vertices.size() > kMost)
    report.distance = band.away[band.vertices[kMost]];
  Neighbourhood near(mesh, seam, fixed, report.distance);
  // What has to go farther than that is no step or crease of a seam, but the fork of two limbs or the brim of a hat:
  // it stays as it is.
  constexpr double kFarthest = 0.5;
  const double farthest = kFarthest * report.distance + gap;
  const std::vector<Vec3> given = near.mesh.vertices;
  constexpr int kAttempts = 5;
  constexpr double kWorthIt = 0.8;  // less than a fifth of the crease is not worth moving the surfaces
  for (int attempt = 0;; ++attempt) {
    near.mesh.vertices = given;
    const std::vector<int> forks = give_way_in_rounds(near, given, farthest, report);
    if (forks.empty() && report.angle_after <= kWorthIt * report.angle_before) break;
    if (forks.empty() || attempt == kAttempts || !hold(near, forks)) {
      report.moved = 0, report.angle_after = report.angle_before;
      return report;
    }
  }
  for (std::size_t i = 0; i < near.vertex.size(); ++i) mesh.vertices[near.vertex[i]] = near.mesh.vertices[i];
  return report;
}

}  // namespace parts::seam
