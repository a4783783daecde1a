// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/seam_score.h"

#include <algorithm>

#include "parts/mesh/edges.h"
#include "parts/spatial/face_tree.h"

namespace parts::cut {
namespace {

/// Edges as faces without area, for a tree of faces.
Mesh as_faces(const std::vector<BorderEdge>& edges) {
  Mesh m;
  for (const BorderEdge& e : edges) {
    const int v = m.vertex_count();
    m.vertices.push_back(e.from), m.vertices.push_back(e.to);
    m.faces.push_back({v, v + 1, v + 1});
  }
  return m;
}

void add_side(const std::vector<BorderEdge>& mine, const Borders& other, SeamScore& score) {
  const double lambda = SeamScore::kLambda * score.scale, reach = SeamScore::kReach * score.scale;
  std::vector<BorderEdge> facing = other.cut;
  facing.insert(facing.end(), other.own.begin(), other.own.end());
  const Mesh faces = as_faces(facing);
  const spatial::FaceTree tree(faces);
  for (const BorderEdge& e : mine) {
    const double half = 0.5 * (e.to - e.from).norm();
    score.length += half * lambda;
    const spatial::FaceTree::Hit hit = tree.nearest(0.5 * (e.from + e.to), reach);
    if (hit.face < 0) {
      score.gap += half * reach, score.unfaced += half * reach;
      continue;
    }
    score.gap += half * hit.distance;
    score.turn += half * lambda * (1 - e.normal.dot(facing[hit.face].normal));
  }
}

}  // namespace

SeamScore score_seam(const Borders& a, const Borders& b, double scale) {
  SeamScore score;
  score.scale = scale;
  add_side(a.cut, b, score);
  add_side(b.cut, a, score);
  return score;
}

double rms_size(const Mesh& mesh) {
  double area = 0, sum = 0;
  Vec3 centroid = Vec3::Zero();
  for (int f = 0; f < mesh.face_count(); ++f) {
    const double w = mesh.area(f);
    area += w, centroid += w * mesh.center(f);
  }
  if (!(area > 0)) return 0;
  centroid /= area;
  for (int f = 0; f < mesh.face_count(); ++f) {  // the integral over the face, in closed form
    double moment = 9 * (mesh.center(f) - centroid).squaredNorm();
    for (int k = 0; k < 3; ++k) moment += (mesh.corner(f, k) - centroid).squaredNorm();
    sum += mesh.area(f) * moment / 12;
  }
  return std::sqrt(sum / area);
}

Borders borders_of(const Mesh& model, const Mesh& clipped) {
  const auto edges = [](const Mesh& mesh) {
    std::vector<BorderEdge> found;
    mesh::for_each_mesh_edge(mesh::sorted_half_edges(mesh), [&](auto first, auto last) {
      if (last - first == 1)
        found.push_back({mesh.vertices[first->from], mesh.vertices[first->to], mesh.normal(first->face)});
    });
    return found;
  };
  const Mesh own = as_faces(edges(model));
  const spatial::FaceTree tree(own);
  const double hair = 1e-7 * rms_size(model);
  Borders borders;
  for (const BorderEdge& e : edges(clipped))
    (tree.nearest(0.5 * (e.from + e.to), hair).face >= 0 ? borders.own : borders.cut).push_back(e);
  return borders;
}

}  // namespace parts::cut
