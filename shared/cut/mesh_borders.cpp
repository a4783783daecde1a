// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/mesh_borders.h"

#include <memory>
#include <unordered_map>
#include <unordered_set>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/loops.h"
#include "parts/spatial/closest_point.h"

namespace parts::cut {
namespace {

std::uint64_t edge_key(int a, int b) {
  return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

/// The work mesh's part of a face that is nearest to a point. A long face may
/// have very many parts.
class PartOfFace {
 public:
  PartOfFace(const WorkMesh& w, const std::vector<char>& faces) {
    std::unordered_map<int, spatial::Surface> surfaces;
    for (int f = 0; f < w.mesh.face_count(); ++f) {
      if (!faces[w.source[f]]) continue;
      parts_[w.source[f]].faces.push_back(f);
      surfaces[w.source[f]].triangles.push_back({w.mesh.corner(f, 0), w.mesh.corner(f, 1), w.mesh.corner(f, 2)});
      surfaces[w.source[f]].normals.push_back(w.mesh.normal(f));
    }
    for (auto& [source, part] : parts_) part.tree = std::make_unique<spatial::TriangleTree>(surfaces[source]);
  }
  int operator()(int source, const Vec3& p) const {
    const Parts& parts = parts_.at(source);
    int hint = 0;
    return parts.faces[parts.tree->closest(p, hint).triangle];
  }

 private:
  struct Parts {
    std::vector<int> faces;
    std::unique_ptr<spatial::TriangleTree> tree;
  };
  std::unordered_map<int, Parts> parts_;
};

/// The line in which the values vanish, as points and segments on the model's own faces.
class BorderLine {
 public:
  BorderLine(const LabelledModel& m, const std::vector<double>& value) : m_(m), w_(m.work), value_(value) {
    place_.resize(w_.mesh.vertices.size());
    for (int v = 0; v < m.mesh.vertex_count(); ++v) place_[v] = SplitPoint::at_vertex(m.mesh.vertices[v], v);
    for (std::size_t p = 0; p < m.points.size(); ++p)
      if (const int v = w_.vertex_of[p]; v >= m.mesh.vertex_count()) place_[v] = m.points[p];
  }

  /// The line's part in a face of the work mesh.
  void add(int face) {
    const Triangle& t = w_.mesh.faces[face];
    std::vector<int> ends;
    for (int k = 0; k < 3; ++k) {
      const int i = t[k], j = t[(k + 1) % 3];
      if (value_[i] == 0) ends.push_back(at_vertex(i, face));
      if (value_[i] * value_[j] < 0) ends.push_back(on_edge(i, j, face));
    }
    if (ends.size() == 2) segments.push_back({w_.source[face], {ends[0], ends[1]}});
  }
  /// An edge of the work mesh as a part of the line.
  void add_edge(const WorkMesh::Edge& e) {
    for (int k = e.first_face; k < e.end_face; ++k)
      if (const int f = w_.edge_faces[k]; may_split(e.low) && may_split(e.high))
        segments.push_back({w_.source[f], {at_vertex(e.low, f), at_vertex(e.high, f)}});
  }
  /// What must stay whole has edges in common with the others.
  bool may_split(int v) const {
    const std::array<int, 2>& edge = place_[v].edge;
    return edge[0] < 0 || !m_.still[edge[0]] || !m_.still[edge[1]];
  }
  /// A point of the work mesh, with its value.
  int at_vertex(int v, int face) {
    const auto [it, fresh] = of_vertex_.try_emplace(v, int(points.size()));
    if (fresh) {
      SplitPoint p = place_[v];
      if (!p.anywhere()) p = in_source(w_.mesh.vertices[v], face);
      points.push_back(p), values.push_back(value_[v]);
    }
    return it->second;
  }

  std::vector<SplitPoint> points;
  std::vector<double> values;
  std::vector<SplitSegment> segments;

 private:
  SplitPoint in_source(const Vec3& p, int face) const {
    const int f = w_.source[face];
    return SplitPoint::in_face(p, f, barycentric(m_.mesh, f, p));
  }
  int on_edge(int i, int j, int face) {
    constexpr double kMargin = 0.01;  // no face gets an edge of no length
    const int low = std::min(i, j), high = std::max(i, j);
    const auto [it, fresh] = of_edge_.try_emplace(edge_key(i, j), int(points.size()));
    if (!fresh) return it->second;
    const double t = std::clamp(value_[low] / (value_[low] - value_[high]), kMargin, 1 - kMargin);
    const Vec3 p = (1 - t) * w_.mesh.vertices[low] + t * w_.mesh.vertices[high];
    // On an edge of the model where both ends are.
    const SplitPoint &from = place_[low], &to = place_[high];
    std::array<int, 2> edge = from.edge[0] >= 0 ? from.edge : to.edge;
    if (from.vertex >= 0 && to.vertex >= 0) edge = {low, high};
    if (edge[0] >= 0 && from.on(edge[0], edge[1]) && to.on(edge[0], edge[1])) {
      const auto share = [&](const SplitPoint& x) { return x.vertex >= 0 ? double(x.vertex == edge[1]) : x.share; };
      points.push_back(SplitPoint::on_edge(p, edge[0], edge[1], (1 - t) * share(from) + t * share(to)));
    } else {
      points.push_back(in_source(p, face));
    }
    values.push_back(0);
    return it->second;
  }

  const LabelledModel& m_;
  const WorkMesh& w_;
  const std::vector<double>& value_;
  std::vector<SplitPoint> place_;  ///< per vertex of the work mesh
  std::unordered_map<int, int> of_vertex_;
  std::unordered_map<std::uint64_t, int> of_edge_;
};

/// Fills MeshBorder::keep_level. The line parts a face into patches; one at
/// which a vertex of the model lies is on its side, of others the values decide.
void keep_level_faces(const LabelledModel& m, const std::vector<double>& value, const std::vector<char>& passed,
                      const BorderLine& line, MeshBorder& border) {
  const WorkMesh& w = m.work;
  const SplitMesh& split = border.split;
  const Mesh& mesh = split.mesh;
  const double sign = m.side ? -1 : 1;
  const Territory own = m.side ? kOfB : kOfA;
  std::vector<Territory> label(m.mesh.faces.size(), 0);  // of faces that are not passed
  for (int f = 0; f < w.mesh.face_count(); ++f) label[w.source[f]] = m.label[f];
  std::unordered_set<std::uint64_t> on_line;
  for (const SplitSegment& s : line.segments)
    on_line.insert(edge_key(split.vertex_of[s.ends[0]], split.vertex_of[s.ends[1]]));
  DisjointSets patches(mesh.face_count());
  std::unordered_map<std::uint64_t, int> across;  // per edge within a face of the model: one of its two
  std::vector<int> level;
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!passed[split.source[f]]) continue;
    const Triangle& t = mesh.faces[f];
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t edge = edge_key(t[k], t[(k + 1) % 3]);
      if (on_line.count(edge)) continue;
      const auto [it, fresh] = across.try_emplace(edge, f);
      if (!fresh && split.source[it->second] == split.source[f]) patches.unite(it->second, f);
      it->second = f;
    }
  }
  const PartOfFace part(w, passed);
  std::unordered_map<int, double> vote;  // per patch
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!passed[split.source[f]]) continue;
    double known = 0;
    for (int v : mesh.faces[f]) known += border.value[v];
    double& sum = vote[patches.find(f)];
    if (known != 0) {
      sum += known > 0 ? 1e100 : -1e100;
      continue;
    }
    const int g = part(split.source[f], mesh.center(f));
    const Vec3 share = barycentric(w.mesh, g, mesh.center(f));
    const Triangle& n = w.mesh.faces[g];
    const double at = share[0] * value[n[0]] + share[1] * value[n[1]] + share[2] * value[n[2]];
    sum += (mesh.area(f) + 1e-300) * (at != 0 ? sign * at : m.label[g] == own ? 1 : -1);
  }
  border.keep_level.assign(mesh.faces.size(), 0);
  for (int f = 0; f < mesh.face_count(); ++f)
    border.keep_level[f] = passed[split.source[f]] ? vote[patches.find(f)] > 0 : label[split.source[f]] == own;
}

}  // namespace

MeshBorder smooth_border(const LabelledModel& m, const SeamValues& values, bool even) {
  const WorkMesh& w = m.work;
  const std::vector<double>& value = values.value[m.side];
  const double sign = m.side ? -1 : 1;
  std::vector<char> passed(m.mesh.faces.size(), 0);  // by the border
  {
    std::vector<char> signs(m.mesh.faces.size(), 0);
    for (int f = 0; f < w.mesh.face_count(); ++f)
      for (int v : w.mesh.faces[f]) signs[w.source[f]] |= value[v] > 0 ? 1 : value[v] < 0 ? 2 : 4;
    for (std::size_t f = 0; f < passed.size(); ++f) passed[f] = signs[f] >= 3;
  }
  BorderLine line(m, value);
  for (int f = 0; f < w.mesh.face_count(); ++f)
    if (passed[w.source[f]]) line.add(f);
  if (even)
    for (int f = 0; f < w.mesh.face_count(); ++f)
      if (passed[w.source[f]])
        for (int v : w.mesh.faces[f])
          if (v >= m.mesh.vertex_count() && line.may_split(v)) line.at_vertex(v, f);
  MeshBorder border;
  border.split = split_faces(m.mesh, line.points, std::vector<char>(line.points.size(), 1), line.segments);
  const SplitMesh& split = border.split;
  border.value.assign(split.mesh.vertices.size(), 0);
  for (int v = 0; v < m.mesh.vertex_count(); ++v) border.value[v] = sign * value[v];
  for (std::size_t p = 0; p < line.points.size(); ++p)
    if (line.points[p].vertex < 0) border.value[split.vertex_of[p]] = sign * line.values[p];
  keep_level_faces(m, value, passed, line, border);
  return border;
}

MeshBorder raw_border(const LabelledModel& m) {
  const WorkMesh& w = m.work;
  const Territory own = m.side ? kOfB : kOfA;
  std::vector<char> kept(m.mesh.faces.size(), 0), dropped = kept, passed = kept;
  for (int f = 0; f < w.mesh.face_count(); ++f) (m.label[f] == own ? kept : dropped)[w.source[f]] = 1;
  for (std::size_t f = 0; f < passed.size(); ++f) passed[f] = kept[f] && dropped[f];
  const std::vector<double> value(w.mesh.vertices.size(), 0);
  BorderLine line(m, value);
  for (const WorkMesh::Edge& e : w.edges)
    if (w.cut(e, m.label)) line.add_edge(e);
  MeshBorder border;
  border.split = split_faces(m.mesh, line.points, std::vector<char>(line.points.size(), 1), line.segments);
  border.value.assign(border.split.mesh.vertices.size(), 0);
  const PartOfFace part(w, passed);
  for (int f = 0; f < border.split.mesh.face_count(); ++f) {
    const int source = border.split.source[f];
    border.keep_level.push_back(passed[source] ? m.label[part(source, border.split.mesh.center(f))] == own
                                               : kept[source]);
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
