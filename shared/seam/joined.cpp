// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/joined.h"

#include "parts/mesh/attributes.h"
#include "parts/mesh/pinches.h"
#include "parts/seam/seam.h"
#include "parts/seam/stitch.h"
#include "parts/seam/untangle.h"

namespace parts::seam {

Joined join_parts(const cut::Model& a, const Clipped& ca, const cut::Model& b, const Clipped& cb) {
  Joined j;
  j.mesh = ca.mesh;
  mesh::append(j.mesh, cb.mesh);
  const int first_b = ca.mesh.vertex_count();
  j.seam = ca.cut_vertex;
  for (char cut : cb.cut_vertex) j.seam.push_back(cut ? kBorderB : kNoSeam);
  j.fixed.assign(j.mesh.vertices.size(), 0), j.closed = j.fixed;
  j.like.assign(j.mesh.vertices.size(), -1);
  for (int f = 0; f < j.mesh.face_count(); ++f) {
    const bool from_b = f >= ca.mesh.face_count();
    const cut::Model& model = from_b ? b : a;
    const int source = from_b ? cb.source_face[f - ca.mesh.face_count()] : ca.source_face[f];
    j.tag.push_back(from_b);
    for (int v : j.mesh.faces[f]) {
      j.like[v] = f;
      j.fixed[v] |= model.keep[source];
      j.closed[v] = model.prepared.closed[model.prepared.component[source]];
    }
  }
  j.loops_a = mesh::trace_loops(ca.border);
  std::vector<std::array<int, 2>> border_b = cb.border;
  for (auto& e : border_b) e[0] += first_b, e[1] += first_b;
  j.loops_b = mesh::trace_loops(border_b);
  return j;
}

namespace {

/// Turns B's part over if the seam says clearly that it faces the other way.
bool agree_on_orientation(Joined& j, std::vector<std::array<int, 2>>& pairs) {
  double balance = 0, length = 0;
  const auto agreement = [&](const auto& p) { return direction_agreement(j.mesh, j.loops_a[p[0]], j.loops_b[p[1]]); };
  for (const auto& p : pairs) {
    const double l = mesh::loop_length(j.mesh, j.loops_a[p[0]]);
    balance += l * agreement(p), length += l;
  }
  const bool turn = balance > 0.5 * length;
  if (turn) {
    std::vector<char> of_b(j.mesh.vertices.size(), 0);
    for (int f = 0; f < j.mesh.face_count(); ++f)
      if (j.tag[f] == 1) {
        for (int v : j.mesh.faces[f]) of_b[v] = 1;
        std::swap(j.mesh.faces[f][1], j.mesh.faces[f][2]);
        if (!j.mesh.wedges.empty()) std::swap(j.mesh.wedges[f].uv[1], j.mesh.wedges[f].uv[2]);
      }
    for (std::size_t v = 0; v < j.mesh.vertex_normal.size(); ++v)
      if (of_b[v]) j.mesh.vertex_normal[v] = -j.mesh.vertex_normal[v];
    for (mesh::Loop& l : j.loops_b) std::reverse(l.vertices.begin(), l.vertices.end());
  }
  // What still runs the wrong way would make a twisted strip.
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), [&](const auto& p) { return agreement(p) > 0; }), pairs.end());
  return turn;
}

}  // namespace

double stitch_parts(Joined& j, double max_gap, SeamReport& report) {
  std::vector<std::array<int, 2>> pairs = mesh::match_loops(j.mesh, j.loops_a, j.loops_b, max_gap, report.seam_gap);
  report.reversed_b = agree_on_orientation(j, pairs);
  std::vector<char> joined_a(j.loops_a.size(), 0), joined_b(j.loops_b.size(), 0);
  for (const auto& [i, k] : pairs) {
    joined_a[i] = joined_b[k] = 1;
    report.seam_length += mesh::loop_length(j.mesh, j.loops_a[i]);
    zipper(j.mesh, j.loops_a[i], j.loops_b[k], j.like);
  }
  report.loops_joined = int(pairs.size());
  // What did not pair off is zippered by pieces. A contour with none opposite:
  // a closed model stays closed.
  const auto rest = [](const std::vector<mesh::Loop>& loops, const std::vector<char>& joined) {
    std::vector<mesh::Loop> r;
    for (std::size_t i = 0; i < loops.size(); ++i)
      if (!joined[i]) r.push_back(loops[i]);
    return r;
  };
  const ZipperedPieces pieces =
      zipper_pieces(j.mesh, rest(j.loops_a, joined_a), rest(j.loops_b, joined_b), max_gap, j.like);
  report.pieces_joined = pieces.strips, report.seam_length += pieces.length;
  double unmatched = 0;
  for (const mesh::Loop& loop : pieces.open) {
    unmatched += mesh::loop_length(j.mesh, loop);
    bool closed = loop.closed;
    for (int v : loop.vertices) closed = closed && j.closed[v];
    if (closed)
      cap(j.mesh, loop, j.like), ++report.loops_capped;
    else
      ++report.loops_open;
  }
  j.tag.resize(j.mesh.faces.size(), 2);
  return unmatched;
}

long finish_seam(Joined& j, double voxel, cut::Cut cut, const SeamSmoothing& smoothing, int threads) {
  if (cut == cut::Cut::Mesh)
    tidy_seam(j.mesh, j.seam, j.fixed, j.tag, {0.35 * voxel, 1.2 * voxel});
  else
    tidy_seam(j.mesh, j.seam, j.fixed, j.tag, {0.2 * voxel, 0.2 * voxel});
  for (int v : mesh::split_pinches(j.mesh, j.seam)) j.seam.push_back(j.seam[v]), j.fixed.push_back(j.fixed[v]);
  const std::vector<Vec3> before = j.mesh.vertices;
  if (cut == cut::Cut::Mesh) even_seam(j.mesh, j.seam, j.fixed, 8);
  smooth_seam(j.mesh, j.seam, j.fixed, smoothing.distance > 0 ? smoothing.distance : 2 * voxel, smoothing.iterations,
              smoothing.weight);
  std::vector<char> movable(j.mesh.vertices.size(), 0);
  for (std::size_t v = 0; v < movable.size(); ++v)
    movable[v] = !j.fixed[v] && (j.seam[v] || before[v] != j.mesh.vertices[v]);
  constexpr int kRounds = 15;
  const long crossings = untangle(j.mesh, movable, kRounds, threads);
  if (j.mesh.vertex_normal.empty()) return crossings;
  // Normals are the inputs' own but around the seam.
  std::vector<Eigen::Vector3f> normals = j.mesh.vertex_normal;
  mesh::update_normals(j.mesh);
  std::vector<char> changed = j.seam;
  for (const Triangle& f : j.mesh.faces) {
    bool any = false;
    for (int v : f) any |= j.seam[v] || before[v] != j.mesh.vertices[v];
    if (any)
      for (int v : f) changed[v] = 1;
  }
  for (std::size_t v = 0; v < normals.size(); ++v)
    if (!changed[v]) j.mesh.vertex_normal[v] = normals[v];
  return crossings;
}

}  // namespace parts::seam
