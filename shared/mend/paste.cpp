// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/paste.h"

#include <algorithm>
#include <set>

#include "parts/mend/islands.h"
#include "parts/mend/patch.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/pinches.h"
#include "parts/mesh/topology.h"
#include "parts/seam/joined.h"
#include "parts/seam/seam.h"

namespace parts::mend {
namespace {

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
    for (int v : rim) j.seam[v] = seam::kBorderA;
  return j;
}

/// All that is open was so before, and the rim is not.
bool closes(const Mesh& before, const mesh::Loop& rim, const Mesh& after) {
  std::set<mesh::EdgePlace> open;
  for (const auto& e : mesh::boundary_half_edges(before)) open.insert(mesh::edge_place(before, e[0], e[1]));
  for (int i = 0; i < rim.size(); ++i) open.erase(mesh::edge_place(before, rim.vertices[i], rim.next(i)));
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

/// Per face of a pasted mesh its number in the scan, whose faces come first and
/// in their order. @param stays  per face of the scan: not covered by the patch
std::vector<int> sources(const std::vector<char>& tag, const std::vector<char>& stays) {
  std::vector<int> source;
  std::size_t next = 0;
  for (char t : tag) {
    if (t) {
      source.push_back(t == 1 ? kFromModel : kFromStitch);
      continue;
    }
    while (!stays[next]) ++next;
    source.push_back(int(next++));
  }
  return source;
}

/// A scan without some of its faces, and its rim there.
struct Cleared {
  Mesh mesh;
  mesh::Loop rim;
  std::vector<char> stays;  ///< per face of the scan
};

Cleared without(const Mesh& scan, const mesh::Loop& rim, const std::vector<char>& gone) {
  Cleared c{{}, rim, std::vector<char>(gone.size())};
  for (std::size_t f = 0; f < gone.size(); ++f) c.stays[f] = !gone[f];
  if (std::find(gone.begin(), gone.end(), 1) == gone.end()) {
    c.mesh = scan;
    return c;
  }
  std::vector<int> old_vertex, number(scan.vertices.size(), -1);
  c.mesh = mesh::take_faces(scan, c.stays, &old_vertex);
  for (std::size_t v = 0; v < old_vertex.size(); ++v) number[old_vertex[v]] = int(v);
  for (int& v : c.rim.vertices) v = number[v];
  return c;
}

/// Of the borders of a scan, those that a patch may reach.
std::vector<mesh::Loop> within_reach(const Mesh& scan, std::vector<mesh::Loop> rims, const Mesh& patch, double gap) {
  const Box reach = patch.bounds();
  const auto beyond = [&](const mesh::Loop& rim) {
    Box b;
    for (int v : rim) b.extend(scan.vertices[v]);
    return reach.exteriorDistance(b) > gap;
  };
  rims.erase(std::remove_if(rims.begin(), rims.end(), beyond), rims.end());
  return rims;
}

/// Joins a patch to the scan's rims, and says whether that has closed the one that was meant.
void join(const Cleared& scan, const seam::Clipped& patch, const PatchOptions& cut, const PasteOptions& options,
          Pasted& out) {
  const std::vector<mesh::Loop> rims = within_reach(scan.mesh, find_rims(scan.mesh), patch.mesh, cut.max_gap);
  seam::Joined j = side_by_side(scan.mesh, patch, rims);
  seam::SeamReport report;
  seam::stitch_parts(j, cut.max_gap, report);
  out.crossings = seam::finish_seam(j, cut.edge, cut::Cut::Mesh, options.smoothing, options.threads);
  drop_unjoined(j.mesh, j.tag);
  out.source = sources(j.tag, scan.stays);
  mesh::weld_steps(j.mesh, out.source);
  const mesh::MeshCheck before = mesh::check(scan.mesh), loose = mesh::check(patch.mesh), after = mesh::check(j.mesh);
  out.joined = report.loops_joined, out.capped = report.loops_capped;
  out.seam_length = report.seam_length, out.seam_gap = report.seam_gap;
  out.closed = report.loops_joined > 0 && closes(scan.mesh, scan.rim, j.mesh) &&
               after.nonmanifold_edges <= before.nonmanifold_edges &&
               after.nonmanifold_vertices <= before.nonmanifold_vertices + loose.nonmanifold_vertices &&
               after.inconsistent_edges <= before.inconsistent_edges;
  out.mesh = std::move(j.mesh);
}

/// @param away  how far from the rim the model is to end, in edges of the rim
Pasted paste_once(const Mesh& scan, const Mesh& model, const mesh::Loop& rim, double away,
                  const PasteOptions& options) {
  Pasted out;
  PatchOptions cut;
  cut.edge = mesh::loop_length(scan, rim) / rim.size();
  cut.tolerance = options.tolerance;
  cut.gap = away * cut.edge;
  cut.max_gap = std::max(3 * cut.edge, 0.5 * options.tolerance) + cut.gap;
  cut.threads = options.threads;
  // Loose pieces: out of the way at first, and back where the patch does not cover them.
  const Islands islands(scan, rim, options.size);
  Cleared cleared = without(scan, rim, islands.flags());
  const seam::Clipped patch = patch_beyond(cleared.mesh, model, find_rims(cleared.mesh), cleared.rim, cut);
  if (patch.mesh.faces.empty()) return out;
  out.reached = true;
  if (islands.any()) cleared = without(scan, rim, islands.covered_by(patch.mesh, 2 * options.tolerance, out.islands));
  join(cleared, patch, cut, options, out);
  return out;
}

}  // namespace

Pasted paste(const Mesh& scan, const Mesh& model, const mesh::Loop& rim, const PasteOptions& options) {
  // As near as can be; where that leaves splinters that do not join, or faces that cross, farther off.
  Pasted best = paste_once(scan, model, rim, 0.4, options);
  for (double away : {1.2, 2.4}) {
    if (best.closed && best.crossings == 0) break;
    Pasted p = paste_once(scan, model, rim, away, options);
    if (p.closed && (!best.closed || p.crossings < best.crossings)) best = std::move(p);
  }
  return best;
}

}  // namespace parts::mend
