// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/rigid_cut.h"

#include <algorithm>
#include <cmath>

#include "parts/base/disjoint_sets.h"
#include "parts/base/error.h"
#include "parts/cut/max_flow.h"
#include "parts/cut/seam_score.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/prepare.h"
#include "parts/spatial/face_tree.h"

namespace parts::compose {
namespace {

constexpr double kLambda = cut::SeamScore::kLambda;

/// A mesh whose vertices at one place are one, without attributes.
Mesh welded(const Mesh& mesh) {
  Mesh w;
  w.vertices = mesh.vertices, w.faces = mesh.faces;
  const std::vector<int> first = mesh::first_at_same_place(mesh);
  for (Triangle& f : w.faces)
    for (int& v : f) v = first[v];
  return w;
}

/// How far a pose parts an edge from its image, and turns the surface there.
class SeamCost {
 public:
  SeamCost(const Mesh& mesh, const std::vector<Eigen::Affine3d>& poses, double scale)
      : mesh_(mesh), poses_(poses), scale_(scale) {
    for (const Eigen::Affine3d& pose : poses) {
      // A mirror image has no face for face: what counts is the nearest of the image.
      if (pose.linear().determinant() < 0) images_.push_back(mesh::transformed(mesh, pose));
    }
    for (const Mesh& image : images_) trees_.emplace_back(image);
  }

  /// @return world units, summed over the poses: the gap, and the price per length
  std::array<double, 2> at(int low, int high, int face, int other) const {
    std::array<double, 2> sum{0, 0};
    for (std::size_t k = 0; k < poses_.size(); ++k) {
      const Vec3 &p = mesh_.vertices[low], &q = mesh_.vertices[high];
      const Vec3 n = (mesh_.area_vector(face) + mesh_.area_vector(other)).normalized();
      double gap, turn;
      if (images_.empty()) {
        gap = 0.5 * ((poses_[k] * p - p).norm() + (poses_[k] * q - q).norm());
        turn = 1 - n.dot((poses_[k].linear() * n).normalized());
      } else {
        const spatial::FaceTree::Hit hit = trees_[k].nearest(0.5 * (p + q), 2 * scale_);
        gap = std::min(hit.distance, 2 * scale_);
        turn = hit.face < 0 ? 2 : 1 - n.dot(images_[k].normal(hit.face));
      }
      sum[0] += gap, sum[1] += kLambda * scale_ * (1 + turn);
    }
    return sum;
  }

 private:
  const Mesh& mesh_;
  const std::vector<Eigen::Affine3d>& poses_;
  const double scale_;
  std::vector<Mesh> images_;
  std::vector<spatial::FaceTree> trees_;
};

/// Components without a mark go with the nearest that has one.
void label_unmarked(const Mesh& mesh, DisjointSets& components, const std::vector<char>& marked,
                    std::vector<char>& moves) {
  std::vector<char> decided(mesh.faces.size(), 0);
  bool any = false;
  for (int f = 0; f < mesh.face_count(); ++f) decided[f] = marked[components.find(f)], any |= !decided[f];
  if (!any) return;
  std::vector<int> old_face;
  const Mesh known = mesh::take_faces(mesh, decided, nullptr, &old_face);
  const spatial::FaceTree tree(known);
  std::vector<spatial::FaceTree::Hit> nearest(mesh.faces.size());  // per component
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (decided[f]) continue;
    spatial::FaceTree::Hit& best = nearest[components.find(f)];
    if (const auto hit = tree.nearest(mesh.center(f), best.distance); hit.face >= 0) best = hit;
  }
  for (int f = 0; f < mesh.face_count(); ++f)
    if (const auto& hit = nearest[components.find(f)]; !decided[f])
      moves[f] = hit.face >= 0 && moves[old_face[hit.face]];
}

}  // namespace

RigidCut cut_rigidly(const Mesh& input, const std::vector<char>& fixed, const std::vector<char>& moving,
                     const std::vector<Eigen::Affine3d>& poses) {
  constexpr std::int64_t kForced = std::int64_t(1) << 52;
  const Mesh mesh = welded(input);
  const double scale = cut::rms_size(mesh);
  if (!(scale > 0)) throw UserError("The model has no extent; choose a layer that holds a surface.");
  const int faces = mesh.face_count();
  const SeamCost cost(mesh, poses, scale);
  const std::vector<mesh::HalfEdge> edges = mesh::sorted_half_edges(mesh);

  cut::WideFlowGraph graph(faces, faces * 3 / 2);
  graph.add_node(faces);
  for (int f = 0; f < faces; ++f) {
    if (fixed[f] && moving[f])
      throw UserError("Some faces are marked both to stay and to move; mark two parts that have no face in common.");
    if (fixed[f] || moving[f]) graph.add_tweights(f, fixed[f] ? kForced : 0, moving[f] ? kForced : 0);
  }
  DisjointSets components(faces);
  mesh::for_each_mesh_edge(edges, [&](auto first, auto last) {
    if (first->from == first->to) return;
    const double length = (mesh.vertices[first->from] - mesh.vertices[first->to]).norm();
    for (auto e = first + 1; e < last; ++e) {
      const auto [gap, price] = cost.at(first->low(), first->high(), (e - 1)->face, e->face);
      const double whole = length * (gap + price) / (scale * scale) * 1e9 / double(poses.size());
      const std::int64_t capacity = 1 + std::int64_t(std::min(std::isfinite(whole) ? whole : 1e15, 1e15));
      graph.add_edge((e - 1)->face, e->face, capacity, capacity);
      components.unite((e - 1)->face, e->face);
    }
  });
  graph.maxflow();

  RigidCut cut;
  std::vector<char> marked(faces, 0);  // per component
  for (int f = 0; f < faces; ++f) {
    cut.moves.push_back(graph.what_segment(f, cut::WideFlowGraph::SOURCE) == cut::WideFlowGraph::SINK);
    if (fixed[f] || moving[f]) marked[components.find(f)] = 1;
  }
  label_unmarked(mesh, components, marked, cut.moves);
  double gaps = 0;
  mesh::for_each_mesh_edge(edges, [&](auto first, auto last) {
    for (auto e = first + 1; e < last; ++e) {
      if (cut.moves[e->face] == cut.moves[first->face]) continue;
      const double length = (mesh.vertices[first->from] - mesh.vertices[first->to]).norm();
      const auto [gap, price] = cost.at(first->low(), first->high(), first->face, e->face);
      cut.seam.push_back({first->low(), first->high()});
      cut.length += length, gaps += length * gap;
      cut.cost += length * (gap + price) / (kLambda * scale * scale);
      break;
    }
  });
  if (cut.length > 0) cut.gap = gaps / cut.length / double(poses.size());
  return cut;
}

}  // namespace parts::compose
