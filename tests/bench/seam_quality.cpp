// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/seam_quality.h"

#include <cmath>
#include <set>

#include "parts/mesh/edges.h"

namespace parts::bench {
namespace {

constexpr double kDegrees = 180 / M_PI;

Vec3 area_normal(const Mesh& m, int f) {
  return (m.corner(f, 1) - m.corner(f, 0)).cross(m.corner(f, 2) - m.corner(f, 0));
}

double smallest_angle(const Mesh& m, int f) {
  double least = M_PI;
  for (int k = 0; k < 3; ++k) {
    const Vec3 u = m.corner(f, (k + 1) % 3) - m.corner(f, k), v = m.corner(f, (k + 2) % 3) - m.corner(f, k);
    least = std::min(least, std::atan2(u.cross(v).norm(), u.dot(v)));
  }
  return least * kDegrees;
}

double edge_ratio(const Mesh& m, int f) {
  double least = 1e300, most = 0;
  for (int k = 0; k < 3; ++k) {
    const double l = (m.corner(f, (k + 1) % 3) - m.corner(f, k)).norm();
    least = std::min(least, l), most = std::max(most, l);
  }
  return most / std::max(least, 1e-12 * most);
}

std::vector<char> near_curve(const Mesh& mesh, const std::vector<Vec3>& curve, double distance) {
  Box reach;
  for (const Vec3& p : curve) reach.extend(p);
  std::vector<char> near(mesh.vertices.size(), 0), faces(mesh.faces.size(), 0);
  for (std::size_t v = 0; v < near.size(); ++v) {
    const Vec3& p = mesh.vertices[v];
    if (reach.exteriorDistance(p) > distance) continue;
    for (const Vec3& q : curve)
      if ((p - q).squaredNorm() <= distance * distance) {
        near[v] = 1;
        break;
      }
  }
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int v : mesh.faces[f]) faces[f] |= near[v];
  return faces;
}

}  // namespace

SeamQuality seam_quality(const Mesh& mesh, const std::vector<Vec3>& curve, double distance) {
  const std::vector<char> zone = near_curve(mesh, curve, distance);
  SeamQuality q;
  std::vector<double> angles;
  double ratios = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!zone[f]) continue;
    angles.push_back(smallest_angle(mesh, f));
    ratios += std::min(edge_ratio(mesh, f), 1000.0);
    q.slivers += angles.back() < 5;
  }
  q.faces = int(angles.size());
  if (q.faces == 0) return q;
  std::sort(angles.begin(), angles.end());
  q.least_angle = angles.front(), q.median_angle = angles[angles.size() / 2];
  q.slivers /= q.faces, q.edge_ratio = ratios / q.faces;

  double weights = 0, sum = 0, squares = 0;
  const std::vector<mesh::HalfEdge> edges = mesh::sorted_half_edges(mesh);
  mesh::for_each_mesh_edge(edges, [&](auto first, auto last) {
    if (last - first != 2 || !zone[first->face] || !zone[first[1].face]) return;
    const Vec3 m = area_normal(mesh, first->face), n = area_normal(mesh, first[1].face);
    if (m.norm() == 0 || n.norm() == 0) return;
    const double angle = std::atan2(m.cross(n).norm(), m.dot(n)) * kDegrees;
    const double w = (mesh.vertices[first->to] - mesh.vertices[first->from]).norm();
    weights += w, sum += w * angle, squares += w * angle * angle;
  });
  const double mean = sum / weights;
  q.dihedral_rms = std::sqrt(squares / weights);
  q.dihedral_spread = std::sqrt(std::max(0.0, squares / weights - mean * mean));
  return q;
}

bool closed_and_oriented(const Mesh& mesh) {
  bool good = mesh.face_count() > 0;
  mesh::for_each_mesh_edge(mesh::sorted_half_edges(mesh),
                           [&](auto first, auto last) { good &= last - first == 2 && first->from == first[1].to; });
  return good;
}

double volume(const Mesh& mesh) {
  double sum = 0;
  for (int f = 0; f < mesh.face_count(); ++f) sum += mesh.corner(f, 0).dot(mesh.corner(f, 1).cross(mesh.corner(f, 2)));
  return sum / 6;
}

double mean_edge(const Mesh& mesh) {
  double sum = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) sum += (mesh.corner(f, (k + 1) % 3) - mesh.corner(f, k)).norm();
  return sum / std::max(1, 3 * mesh.face_count());
}

double share_of_input_vertices(const Mesh& result, const Mesh& a, const Mesh& b) {
  const auto place = [](const Vec3& p) { return std::array<float, 3>{float(p[0]), float(p[1]), float(p[2])}; };
  std::set<std::array<float, 3>> known;
  for (const Mesh* m : {&a, &b})
    for (const Vec3& p : m->vertices) known.insert(place(p));
  double found = 0;
  for (const Vec3& p : result.vertices) found += known.count(place(p));
  return found / std::max(1, result.vertex_count());
}

}  // namespace parts::bench
