// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/mesh_borders.h"

#include <memory>
#include <unordered_map>
#include <unordered_set>

#include "parts/mesh/edges.h"
#include "parts/mesh/loops.h"
#include "parts/spatial/closest_point.h"

namespace parts::cut {
namespace {

std::uint64_t edge_key(int a, int b) {
  return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

/// The points on and in the model's flagged faces.
std::vector<char> points_of(const LabelledModel& m, const std::vector<char>& faces) {
  std::unordered_set<std::uint64_t> edges;
  for (int f = 0; f < m.mesh.face_count(); ++f)
    for (int k = 0; faces[f] && k < 3; ++k) edges.insert(edge_key(m.mesh.faces[f][k], m.mesh.faces[f][(k + 1) % 3]));
  std::vector<char> used(m.points.size(), 0);
  for (std::size_t p = 0; p < used.size(); ++p) {
    const SplitPoint& point = m.points[p];
    used[p] = point.face >= 0 ? faces[point.face] != 0 : edges.count(edge_key(point.edge[0], point.edge[1])) > 0;
  }
  return used;
}

/// The label of the work mesh's part of a face that is nearest to a point. A
/// long face may have very many parts.
class LabelOfPart {
 public:
  LabelOfPart(const WorkMesh& w, const std::vector<Territory>& label, const std::vector<char>& faces) : label_(label) {
    std::unordered_map<int, spatial::Surface> surfaces;
    for (int f = 0; f < w.mesh.face_count(); ++f) {
      if (!faces[w.source[f]]) continue;
      parts_[w.source[f]].faces.push_back(f);
      surfaces[w.source[f]].triangles.push_back({w.mesh.corner(f, 0), w.mesh.corner(f, 1), w.mesh.corner(f, 2)});
      surfaces[w.source[f]].normals.push_back(w.mesh.normal(f));
    }
    for (auto& [source, part] : parts_) part.tree = std::make_unique<spatial::TriangleTree>(surfaces[source]);
  }
  Territory operator()(int source, const Vec3& p) const {
    const Parts& parts = parts_.at(source);
    int hint = 0;
    return label_[parts.faces[parts.tree->closest(p, hint).triangle]];
  }

 private:
  struct Parts {
    std::vector<int> faces;
    std::unique_ptr<spatial::TriangleTree> tree;
  };
  const std::vector<Territory>& label_;
  std::unordered_map<int, Parts> parts_;
};

}  // namespace

MeshBorder smooth_border(const LabelledModel& m, const SeamValues& values) {
  const WorkMesh& w = m.work;
  const double sign = m.side ? -1 : 1;
  std::vector<char> passed(m.mesh.faces.size(), 0);  // by the border
  {
    std::vector<char> signs(m.mesh.faces.size(), 0);
    for (int f = 0; f < w.mesh.face_count(); ++f)
      for (int v : w.mesh.faces[f])
        signs[w.source[f]] |= values.value[m.side][v] > 0 ? 1 : values.value[m.side][v] < 0 ? 2 : 4;
    for (std::size_t f = 0; f < passed.size(); ++f) passed[f] = signs[f] >= 3;
  }
  std::vector<char> used = points_of(m, passed);
  std::fill_n(used.begin(), m.curve.points.size(), 0);
  std::vector<SplitSegment> segments;
  for (std::size_t s = 0; s < m.curve.segments.size(); ++s) {
    if (!values.pinned[s]) continue;
    const CrossingSegment& segment = m.curve.segments[s];
    segments.push_back({m.side ? segment.face_b : segment.face_a, segment.ends});
    for (int end : segment.ends) used[end] = 1;
  }
  MeshBorder border;
  border.split = split_faces(m.mesh, m.points, used, segments);
  const SplitMesh& split = border.split;
  border.value.assign(split.mesh.vertices.size(), 0);
  for (int v = 0; v < m.mesh.vertex_count(); ++v) border.value[v] = sign * values.value[m.side][v];
  for (std::size_t p = 0; p < used.size(); ++p)
    if (used[p]) border.value[split.vertex_of[p]] = sign * values.value[m.side][w.vertex_of[p]];
  const LabelOfPart label(w, m.label, passed);
  border.keep_level.assign(split.mesh.faces.size(), 0);
  for (int f = 0; f < split.mesh.face_count(); ++f) {
    const Triangle& t = split.mesh.faces[f];
    if (border.value[t[0]] == 0 && border.value[t[1]] == 0 && border.value[t[2]] == 0)
      border.keep_level[f] = label(split.source[f], split.mesh.center(f)) == (m.side ? kOfB : kOfA);
  }
  return border;
}

MeshBorder raw_border(const LabelledModel& m) {
  const WorkMesh& w = m.work;
  const Territory own = m.side ? kOfB : kOfA;
  std::vector<char> kept(m.mesh.faces.size(), 0), dropped = kept, passed = kept;
  for (int f = 0; f < w.mesh.face_count(); ++f) (m.label[f] == own ? kept : dropped)[w.source[f]] = 1;
  for (std::size_t f = 0; f < passed.size(); ++f) passed[f] = kept[f] && dropped[f];
  std::vector<char> used = points_of(m, passed);
  for (std::size_t p = 0; p < used.size(); ++p) {  // what must stay whole has edges in common with what is passed
    const SplitPoint& point = m.points[p];
    if (point.face < 0 && m.still[point.edge[0]] && m.still[point.edge[1]]) used[p] = 0;
  }
  std::vector<SplitSegment> segments;
  for (const CrossingSegment& s : m.curve.segments)
    if (const int f = m.side ? s.face_b : s.face_a; passed[f] && used[s.ends[0]] && used[s.ends[1]])
      segments.push_back({f, s.ends});
  MeshBorder border;
  border.split = split_faces(m.mesh, m.points, used, segments);
  border.value.assign(border.split.mesh.vertices.size(), 0);
  const LabelOfPart label(w, m.label, passed);
  for (int f = 0; f < border.split.mesh.face_count(); ++f) {
    const int source = border.split.source[f];
    border.keep_level.push_back(passed[source] ? label(source, border.split.mesh.center(f)) == own : kept[source]);
  }
  return border;
}

int count_loops(const LabelledModel& m) {
  const WorkMesh& w = m.work;
  std::vector<std::array<int, 2>> border;
  for (const WorkMesh::Edge& e : w.edges) {
    int kept = 0, face = -1;
    for (int k = e.first_face; k < e.end_face; ++k)
      if (m.label[w.edge_faces[k]] == (m.side ? kOfB : kOfA)) ++kept, face = w.edge_faces[k];
    if (kept != 1 || e.end_face - e.first_face < 2) continue;
    const Triangle& t = w.mesh.faces[face];
    for (int k = 0; k < 3; ++k)
      if (std::min(t[k], t[(k + 1) % 3]) == e.low && std::max(t[k], t[(k + 1) % 3]) == e.high)
        border.push_back({t[k], t[(k + 1) % 3]});
  }
  return int(mesh::trace_loops(border).size());
}

}  // namespace parts::cut
