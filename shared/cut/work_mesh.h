// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "parts/cut/split_faces.h"
#include "parts/cut/volume.h"
#include "parts/spatial/face_tree.h"

namespace parts::cut {

/// A territory: whose surface is kept there. 0 = not decided.
using Territory = signed char;
constexpr Territory kOfA = 1, kOfB = -1;

/// One model as the cut sees it: without attributes, split along the curve in
/// which the models cross and where its edges are long, with what lies nearest
/// on the other model.
struct WorkMesh {
  struct Edge {
    int low, high;             ///< vertices
    int first_face, end_face;  ///< indices into edge_faces
    double turn = -1;          ///< on a crossing: 1 - cosine between the two models' normals there
    bool crossing() const { return turn >= 0; }
  };
  /// What is nearest on the other model.
  struct Near {
    int face = -1;  ///< -1 = nothing within the reach, or what is there looks the other way
    Vec3 point = Vec3::Zero();
    double distance = 1e300;
    bool opposite = false;  ///< it looks the other way
    bool beside = false;    ///< beyond the other model's border
  };

  Mesh mesh;
  std::vector<int> source;     ///< per face: of the model
  std::vector<int> vertex_of;  ///< per split point
  std::vector<Vec3> normal;    ///< per face, unit
  std::vector<Vec3> vertex_normal;
  std::vector<double> area;       ///< per face
  std::vector<Territory> forced;  ///< per face: where marks, or a coarser cut, leave no choice
  std::vector<char> whole;        ///< per face: not wholly within the volume, so never cut
  std::vector<int> twin;          ///< per face: the other's face that it is one with, between the same points; or -1
  std::vector<Edge> edges;
  std::vector<int> edge_faces;
  std::vector<char> at_border;  ///< per face: has an edge without a second face
  std::vector<Near> face_near, vertex_near;
  std::unique_ptr<spatial::FaceTree> tree;

  /// Whether labels differ across an edge.
  bool cut(const Edge& e, const std::vector<Territory>& label) const {
    for (int k = e.first_face + 1; k < e.end_face; ++k)
      if (label[edge_faces[k]] != label[edge_faces[e.first_face]]) return true;
    return false;
  }
  double length(const Edge& e) const { return (mesh.vertices[e.low] - mesh.vertices[e.high]).norm(); }
  /// 1 - cosine between an edge's faces and what is nearest to them, their mean.
  double turn_to(const WorkMesh& other, const Edge& e) const;
};

/// @param forced  per face of the model
WorkMesh make_work_mesh(const Model& model, const Box& volume, const std::vector<Territory>& forced,
                        const std::vector<SplitPoint>& points, const std::vector<SplitSegment>& segments);

/// Looks for what is nearest on the other model up to `reach` (world units),
/// where a smaller reach found nothing yet. Faces whose label is forced are left out.
void look_nearby(WorkMesh& mine, const WorkMesh& other, double reach, int threads);

}  // namespace parts::cut
