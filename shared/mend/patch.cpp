// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/patch.h"

#include <algorithm>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/topology.h"
#include "parts/spatial/closest_face.h"

namespace parts::mend {

RimDistance::RimDistance(const Mesh& scan, const std::vector<mesh::Loop>& rims) {
  spatial::Surface segments;
  for (const mesh::Loop& rim : rims)
    for (int i = 0; i < rim.edges(); ++i) {
      const Vec3 &a = scan.vertices[rim.vertices[i]], &b = scan.vertices[rim.next(i)];
      if (a == b) continue;
      segments.triangles.push_back({a, b, b});  // a triangle of no width
      segments.normals.push_back(Vec3::UnitZ());
    }
  tree_ = std::make_unique<spatial::TriangleTree>(segments);
}

double RimDistance::operator()(const Vec3& p) const {
  int hint = 0;
  return (tree_->closest(p, hint).point - p).norm();
}

namespace {

/// Faces of the model that seem to lie on the scan but in the midst of others
/// that do not: the scan's own lower lip, say, within the upper one that is missing.
std::vector<char> enclosed(const Mesh& model, const std::vector<char>& covered) {
  DisjointSets sets(model.vertex_count());
  const auto same = [&](int a, int b) {
    if (covered[a] && covered[b]) sets.unite(a, b);
  };
  long beyond = 0;
  for (const Triangle& f : model.faces) {
    same(f[0], f[1]), same(f[1], f[2]), same(f[2], f[0]);
    beyond += !covered[f[0]] && !covered[f[1]] && !covered[f[2]];
  }
  std::vector<long> count(model.vertices.size(), 0);
  for (int v = 0; v < model.vertex_count(); ++v)
    if (covered[v]) ++count[sets.find(v)];
  constexpr double kSmall = 0.1;  // of what lies beyond the border
  std::vector<char> flags(model.faces.size(), 0);
  for (int f = 0; f < model.face_count(); ++f)
    for (int v : model.faces[f]) flags[f] |= covered[v] && double(count[sets.find(v)]) < kSmall * double(beyond);
  return flags;
}

/// The model's part that lies beyond the scan's borders.
seam::Clipped beyond_border(const Mesh& scan, const Mesh& model, const std::vector<mesh::Loop>& rims,
                            const PatchOptions& options) {
  const spatial::ClosestFace on_scan(scan), on_model(model);
  const RimDistance to_rim(scan, rims);
  const auto covers = [&](const spatial::FaceHit& hit, const Vec3& normal) {
    return !hit.on_border && hit.distance <= options.tolerance && hit.normal.dot(normal) > 0;
  };
  std::vector<Vec3> normals(model.vertices.size(), Vec3::Zero());
  for (int f = 0; f < model.face_count(); ++f)
    for (int v : model.faces[f]) normals[v] += model.area_vector(f);
  std::vector<char> covered(model.vertices.size(), 0);
  int hint = 0;
  for (int v = 0; v < model.vertex_count(); ++v) covered[v] = covers(on_scan(model.vertices[v], hint), normals[v]);
  const std::vector<char> island = enclosed(model, covered);
  seam::ClipField field;
  field.value = [&](const Vec3& p) {
    const spatial::FaceHit hit = on_scan(p), own = on_model(p);
    const double d = to_rim(p);
    return (!island[own.face] && covers(hit, own.normal) ? -d : d) - options.gap;
  };
  field.crosses = [&](const Mesh& m, int f) {
    const Box b = m.face_box(f);
    return to_rim(b.center()) <= options.gap + b.diagonal().norm();
  };
  field.max_edge = options.edge;
  return seam::clip(model, std::vector<signed char>(model.faces.size(), 0), field, options.threads);
}

/// Keeps the components with flag 1 (by the number of vertex_components).
void keep_components(seam::Clipped& c, const std::vector<int>& component, const std::vector<char>& keep) {
  std::vector<char> flags(c.mesh.faces.size());
  for (std::size_t f = 0; f < flags.size(); ++f) flags[f] = keep[component[c.mesh.faces[f][0]]];
  std::vector<int> old_vertex, old_face, number(c.mesh.vertices.size(), -1);
  seam::Clipped out;
  out.mesh = mesh::take_faces(c.mesh, flags, &old_vertex, &old_face);
  for (int f : old_face) out.source_face.push_back(c.source_face[f]);
  for (std::size_t v = 0; v < old_vertex.size(); ++v) {
    number[old_vertex[v]] = int(v);
    out.cut_vertex.push_back(c.cut_vertex[old_vertex[v]]);
  }
  for (const auto& e : c.border)
    if (number[e[0]] >= 0 && number[e[1]] >= 0) out.border.push_back({number[e[0]], number[e[1]]});
  c = std::move(out);
}

/// Of what lies beyond the borders, the pieces that face this rim, no farther than max_gap on average.
void keep_facing(seam::Clipped& patch, const Mesh& scan, const mesh::Loop& rim, double max_gap) {
  const RimDistance to_rim(scan, {rim});
  const std::vector<int> component = mesh::vertex_components(patch.mesh);
  std::vector<double> facing(patch.mesh.vertices.size(), 0);  // length of such borders, per component
  for (const mesh::Loop& loop : mesh::trace_loops(patch.border)) {
    double sum = 0;
    for (int v : loop.vertices) sum += to_rim(patch.mesh.vertices[v]);
    if (sum <= max_gap * loop.size()) facing[component[loop.vertices[0]]] += mesh::loop_length(patch.mesh, loop);
  }
  // Splinters between the rim's teeth are left to the stitch.
  const double most = facing.empty() ? 0 : *std::max_element(facing.begin(), facing.end());
  std::vector<char> keep(facing.size(), 0);
  for (std::size_t c = 0; c < keep.size(); ++c) keep[c] = facing[c] > 0 && facing[c] >= 0.2 * most;
  keep_components(patch, component, keep);
}

}  // namespace

seam::Clipped patch_beyond(const Mesh& scan, const Mesh& model, const std::vector<mesh::Loop>& rims,
                           const mesh::Loop& rim, const PatchOptions& options) {
  seam::Clipped patch = beyond_border(scan, model, rims, options);
  keep_facing(patch, scan, rim, options.max_gap);
  return patch;
}

}  // namespace parts::mend
