// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/paste.h"

#include <algorithm>
#include <set>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/topology.h"
#include "parts/seam/clip.h"
#include "parts/seam/joined.h"
#include "parts/seam/seam.h"
#include "parts/spatial/closest_face.h"

namespace parts::mend {
namespace {

/// The distance to the borders of a scan.
class RimDistance {
 public:
  RimDistance(const Mesh& scan, const std::vector<mesh::Loop>& rims) {
    spatial::Surface segments;
    for (const mesh::Loop& rim : rims)
      for (int i = 0; i < rim.size(); ++i) {
        const Vec3 &a = scan.vertices[rim.vertices[i]], &b = scan.vertices[rim.vertices[(i + 1) % rim.size()]];
        if (a == b) continue;
        segments.triangles.push_back({a, b, b});  // a triangle of no width
        segments.normals.push_back(Vec3::UnitZ());
      }
    tree_ = std::make_unique<spatial::TriangleTree>(segments);
  }
  double operator()(const Vec3& p) const {
    int hint = 0;
    return (tree_->closest(p, hint).point - p).norm();
  }

 private:
  std::unique_ptr<spatial::TriangleTree> tree_;
};

double mean_edge(const Mesh& mesh, const mesh::Loop& rim) { return mesh::loop_length(mesh, rim) / rim.size(); }

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
/// @param gap  how far from them it ends, world units
seam::Clipped beyond_border(const Mesh& scan, const Mesh& model, const std::vector<mesh::Loop>& rims, double edge,
                            double gap, const PasteOptions& options) {
  const spatial::ClosestFace on_scan(scan), on_model(model);
  const RimDistance to_rim(scan, rims);
  const auto covers = [&](const spatial::FaceHit& hit, const Vec3& normal) {
    return !hit.on_border && hit.distance <= options.tolerance && hit.normal.dot(normal) > 0;
  };
  std::vector<char> covered(model.vertices.size(), 0);
  {
    std::vector<Vec3> normals(model.vertices.size(), Vec3::Zero());
    for (const Triangle& f : model.faces) {
      const Vec3 n = (model.vertices[f[1]] - model.vertices[f[0]]).cross(model.vertices[f[2]] - model.vertices[f[0]]);
      for (int v : f) normals[v] += n;
    }
    int hint = 0;
    for (int v = 0; v < model.vertex_count(); ++v) covered[v] = covers(on_scan(model.vertices[v], hint), normals[v]);
  }
  const std::vector<char> island = enclosed(model, covered);
  seam::ClipField field;
  field.value = [&](const Vec3& p) {
    const spatial::FaceHit hit = on_scan(p), own = on_model(p);
    const double d = to_rim(p);
    return (!island[own.face] && covers(hit, own.normal) ? -d : d) - gap;
  };
  field.crosses = [&](const Mesh& m, int f) {
    const Box b = m.face_box(f);
    return to_rim(b.center()) <= gap + b.diagonal().norm();
  };
  field.max_edge = edge;
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

/// Flags of the scan's faces that belong to small loose pieces within the region.
std::vector<char> loose_pieces(const Mesh& scan, const mesh::Loop& rim, double size) {
  const std::vector<int> component = mesh::vertex_components(scan);
  const int own = component[rim.vertices[0]];
  std::vector<Box> box(scan.vertices.size());
  for (int v = 0; v < scan.vertex_count(); ++v) box[component[v]].extend(scan.vertices[v]);
  Box hole;
  for (int v : rim.vertices) hole.extend(scan.vertices[v]);
  hole.min().array() -= 0.25 * size, hole.max().array() += 0.25 * size;
  std::vector<char> loose(scan.faces.size(), 0);
  for (int f = 0; f < scan.face_count(); ++f) {
    const int c = component[scan.faces[f][0]];
    loose[f] = c != own && hole.contains(box[c]) && box[c].diagonal().norm() < 0.8 * hole.diagonal().norm();
  }
  return loose;
}

/// Of the loose pieces, those that the patch runs along: an eyeball behind its lids mostly does not.
std::vector<char> covered_pieces(const Mesh& scan, const std::vector<char>& loose, const Mesh& patch, double near) {
  const std::vector<int> component = mesh::vertex_components(scan);
  const spatial::ClosestFace on_patch(patch);
  std::vector<long> count(scan.vertices.size(), 0), close(scan.vertices.size(), 0);
  for (int f = 0; f < scan.face_count(); ++f) {
    if (!loose[f]) continue;
    const Vec3 center = (scan.corner(f, 0) + scan.corner(f, 1) + scan.corner(f, 2)) / 3;
    const Vec3 n = (scan.corner(f, 1) - scan.corner(f, 0)).cross(scan.corner(f, 2) - scan.corner(f, 0));
    const spatial::FaceHit hit = on_patch(center);
    ++count[component[scan.faces[f][0]]];
    close[component[scan.faces[f][0]]] += hit.distance <= near && !hit.on_border && hit.normal.dot(n) > 0;
  }
  std::vector<char> covered(scan.faces.size(), 0);
  for (int f = 0; f < scan.face_count(); ++f)
    if (const int c = component[scan.faces[f][0]]; loose[f]) covered[f] = close[c] >= 0.8 * count[c];
  return covered;
}

seam::Joined side_by_side(const Mesh& scan, const seam::Clipped& patch, const std::vector<mesh::Loop>& rims) {
  seam::Joined j;
  j.mesh = scan;
  mesh::append(j.mesh, patch.mesh);
  const int first = scan.vertex_count();
  j.seam.assign(j.mesh.vertices.size(), seam::kNoSeam), j.fixed.assign(j.mesh.vertices.size(), 0);
  j.closed.assign(j.mesh.vertices.size(), 0), j.like.assign(j.mesh.vertices.size(), -1);
  std::fill(j.fixed.begin(), j.fixed.begin() + first, 1);
  for (std::size_t v = first; v < j.closed.size(); ++v) {
    j.closed[v] = 1;
    if (patch.cut_vertex[v - first]) j.seam[v] = seam::kBorderB;
  }
  for (int f = 0; f < j.mesh.face_count(); ++f) {
    j.tag.push_back(f >= scan.face_count());
    for (int v : j.mesh.faces[f]) j.like[v] = f;
  }
  j.loops_a = rims;
  std::vector<std::array<int, 2>> border = patch.border;
  for (auto& e : border) e[0] += first, e[1] += first;
  j.loops_b = mesh::trace_loops(border);
  for (const mesh::Loop& rim : rims)
    for (int v : rim.vertices) j.seam[v] = seam::kBorderA;
  return j;
}

/// All that is open was so before, and the rim is not.
bool closes(const Mesh& before, const mesh::Loop& rim, const Mesh& after) {
  std::set<mesh::EdgePlace> open;
  for (const auto& e : mesh::boundary_half_edges(before)) open.insert(mesh::edge_place(before, e[0], e[1]));
  for (int i = 0; i < rim.size(); ++i)
    open.erase(mesh::edge_place(before, rim.vertices[i], rim.vertices[(i + 1) % rim.size()]));
  const auto left = mesh::boundary_half_edges(after);
  return std::all_of(left.begin(), left.end(),
                     [&](const auto& e) { return open.count(mesh::edge_place(after, e[0], e[1])) > 0; });
}

/// Pieces of the model that were joined to nothing go.
void drop_unjoined(Mesh& mesh, std::vector<char>& tag) {
  const std::vector<int> component = mesh::vertex_components(mesh);
  std::vector<char> of_scan(mesh.vertices.size(), 0), keep(tag.size());
  for (std::size_t f = 0; f < tag.size(); ++f)
    if (!tag[f]) of_scan[component[mesh.faces[f][0]]] = 1;
  for (std::size_t f = 0; f < tag.size(); ++f) keep[f] = of_scan[component[mesh.faces[f][0]]];
  if (std::find(keep.begin(), keep.end(), 0) == keep.end()) return;
  std::vector<int> old_face;
  mesh = mesh::take_faces(mesh, keep, nullptr, &old_face);
  std::vector<char> left;
  for (int f : old_face) left.push_back(tag[f]);
  tag = std::move(left);
}

/// @param away  how far from the rim the model is to end, in edges of the rim
Pasted paste(const Mesh& scan_with_islands, const Mesh& model, const mesh::Loop& rim_with_islands, double away,
             const PasteOptions& options) {
  Pasted out;
  // Loose pieces: out of the way at first, and back where the patch does not cover them.
  Mesh scan = scan_with_islands;
  mesh::Loop rim = rim_with_islands;
  const auto without = [&](const std::vector<char>& gone) {
    std::vector<char> keep(gone.size());
    for (std::size_t f = 0; f < gone.size(); ++f) keep[f] = !gone[f];
    std::vector<int> old_vertex, number(scan_with_islands.vertices.size(), -1);
    scan = mesh::take_faces(scan_with_islands, keep, &old_vertex);
    for (std::size_t v = 0; v < old_vertex.size(); ++v) number[old_vertex[v]] = int(v);
    for (std::size_t i = 0; i < rim.vertices.size(); ++i) rim.vertices[i] = number[rim_with_islands.vertices[i]];
  };
  const std::vector<char> loose = loose_pieces(scan_with_islands, rim_with_islands, options.size);
  const bool any_loose = std::find(loose.begin(), loose.end(), 1) != loose.end();
  if (any_loose) without(loose);

  const double edge = mean_edge(scan, rim), max_gap = std::max(3 * edge, 0.5 * options.tolerance) + away * edge;
  std::vector<mesh::Loop> rims = find_rims(scan);
  seam::Clipped patch = beyond_border(scan, model, rims, edge, away * edge, options);
  keep_facing(patch, scan, rim, max_gap);
  if (patch.mesh.faces.empty()) return out;
  if (any_loose) {
    const std::vector<char> covered = covered_pieces(scan_with_islands, loose, patch.mesh, 2 * options.tolerance);
    without(covered);
    std::vector<int> pieces = mesh::vertex_components(scan_with_islands);
    std::vector<char> seen(pieces.size(), 0);
    for (std::size_t f = 0; f < covered.size(); ++f)
      if (const int c = pieces[scan_with_islands.faces[f][0]]; covered[f] && !seen[c]) seen[c] = 1, ++out.islands;
    rims = find_rims(scan);
  }
  // Only rims that the patch may reach.
  Box reach = patch.mesh.bounds();
  rims.erase(std::remove_if(rims.begin(), rims.end(),
                            [&](const mesh::Loop& l) {
                              Box b;
                              for (int v : l.vertices) b.extend(scan.vertices[v]);
                              return reach.exteriorDistance(b) > max_gap;
                            }),
             rims.end());
  seam::Joined j = side_by_side(scan, patch, rims);
  const mesh::MeshCheck before = mesh::check(scan), loose_patch = mesh::check(patch.mesh);
  seam::SeamReport report;
  seam::stitch_parts(j, max_gap, report);
  out.crossings = seam::finish_seam(j, edge, cut::Cut::Mesh, options.smoothing, options.threads);
  drop_unjoined(j.mesh, j.tag);
  const mesh::MeshCheck after = mesh::check(j.mesh);
  out.joined = report.loops_joined, out.capped = report.loops_capped;
  out.seam_length = report.seam_length, out.seam_gap = report.seam_gap;
  out.closed = report.loops_joined > 0 && closes(scan, rim, j.mesh) &&
               after.nonmanifold_edges <= before.nonmanifold_edges &&
               after.nonmanifold_vertices <= before.nonmanifold_vertices + loose_patch.nonmanifold_vertices &&
               after.inconsistent_edges <= before.inconsistent_edges;
  out.mesh = std::move(j.mesh);
  out.face_from_model = std::move(j.tag);
  return out;
}

}  // namespace

Pasted paste(const Mesh& scan, const Mesh& model, const mesh::Loop& rim, const PasteOptions& options) {
  // As near as can be; where that leaves splinters that do not join, or faces that cross, farther off.
  Pasted best;
  for (double away : {0.4, 1.2, 2.4}) {
    Pasted p = paste(scan, model, rim, away, options);
    if (away == 0.4 || (p.closed && (!best.closed || p.crossings < best.crossings))) best = std::move(p);
    if (best.closed && best.crossings == 0) break;
  }
  return best;
}

}  // namespace parts::mend
