// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/joined.h"

#include <algorithm>

#include "parts/mesh/attributes.h"
#include "parts/mesh/pinches.h"
#include "parts/seam/band.h"
#include "parts/seam/contours.h"
#include "parts/seam/seam.h"
#include "parts/seam/untangle.h"

namespace parts::seam {
namespace {

/// A clipped model's contours: those that the cut made or that it opened, and
/// those that the model had. Adds the half-edges that it had to `own`.
void trace_contours(const Clipped& clipped, int first_vertex, std::vector<mesh::Loop>& made,
                    std::vector<mesh::Loop>& had, HalfEdges& own) {
  HalfEdges border = clipped.border, all = border, old;
  std::sort(border.begin(), border.end());
  for (const auto& e : mesh::boundary_half_edges(clipped.mesh))
    if (!contains(border, e)) all.push_back(e), old.push_back({e[0] + first_vertex, e[1] + first_vertex});
  for (mesh::Loop& loop : mesh::trace_loops(all)) {
    bool any = false;
    for_each_half_edge(loop, [&](const auto& e) { any |= contains(border, e); });
    for (int& v : loop.vertices) v += first_vertex;
    (any ? made : had).push_back(std::move(loop));
  }
  own.insert(own.end(), old.begin(), old.end());
}

bool all_closed(const cut::Model& model) {
  const std::vector<char>& closed = model.prepared.closed;
  return std::find(closed.begin(), closed.end(), 0) == closed.end();
}

}  // namespace

Joined join_parts(const cut::Model& a, const Clipped& ca, const cut::Model& b, const Clipped& cb) {
  Joined j;
  j.mesh = ca.mesh;
  mesh::append(j.mesh, cb.mesh);
  j.seam = ca.cut_vertex;
  for (char cut : cb.cut_vertex) j.seam.push_back(cut ? kBorderB : kNoSeam);
  j.fixed.assign(j.mesh.vertices.size(), 0);
  j.closed.assign(j.mesh.vertices.size(), 1);
  j.like.assign(j.mesh.vertices.size(), -1);
  for (int f = 0; f < j.mesh.face_count(); ++f) {
    const bool from_b = f >= ca.mesh.face_count();
    const cut::Model& model = from_b ? b : a;
    const int source = from_b ? cb.source_face[f - ca.mesh.face_count()] : ca.source_face[f];
    j.tag.push_back(from_b);
    const Clipped& clipped = from_b ? cb : ca;
    j.same.push_back(!clipped.same.empty() && clipped.same[from_b ? f - ca.mesh.face_count() : f]);
    for (int v : j.mesh.faces[f]) {
      j.like[v] = f;
      j.fixed[v] |= model.keep[source];
    }
  }
  trace_contours(ca, 0, j.loops_a, j.own_a, j.own);
  trace_contours(cb, ca.mesh.vertex_count(), j.loops_b, j.own_b, j.own);
  std::sort(j.own.begin(), j.own.end());
  j.may_turn_b = !(all_closed(a) && all_closed(b));
  return j;
}

namespace {

/// Normals are the inputs' own but around what was made or moved.
void mend_normals(Joined& j, const std::vector<Vec3>& before) {
  if (j.mesh.vertex_normal.empty()) return;
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
}

/// What smoothing changes of a mesh.
struct Shape {
  std::vector<Vec3> vertices;
  std::vector<Triangle> faces;
  std::vector<Wedges> wedges;
};

Shape shape_of(const Mesh& m) { return {m.vertices, m.faces, m.wedges}; }
void set_shape(Mesh& m, const Shape& s) { m.vertices = s.vertices, m.faces = s.faces, m.wedges = s.wedges; }

/// Blends, smooths and untangles. @return pairs of faces at the seam that cross
/// @param held  per vertex: does not give way
std::vector<std::array<int, 2>> smooth_all(Joined& j, const std::vector<Vec3>& before, const std::vector<char>& held,
                                           double edge, double distance, const SeamSmoothing& smoothing, int threads) {
  j.blend = {};
  std::vector<char> seam = j.seam;  // where there is something to smooth
  for (char& s : seam)
    if (s & kStill) s = kNoSeam;
  if (smoothing.blend) {
    j.blend = blend_seam(j.mesh, seam, held, smoothing.blend_distance, j.gap);
    if (j.blend.moved > 0) flip_seam(j.mesh, j.seam, j.fixed);
  }
  smooth_seam(j.mesh, seam, j.fixed, distance, smoothing.iterations, smoothing.weight);
  std::vector<char> movable(j.mesh.vertices.size(), 0);
  for (std::size_t v = 0; v < movable.size(); ++v)
    movable[v] = !j.fixed[v] && (j.seam[v] || before[v] != j.mesh.vertices[v]);
  constexpr int kRounds = 15;
  constexpr double kLargestFold = 3;  // edges of the seam
  return untangle(j.mesh, {movable, j.seam, j.tag, before, kLargestFold * edge, kRounds, threads});
}

/// Holds the vertices of faces, and those within a distance of them along the surface.
void hold(const Mesh& mesh, const std::vector<std::array<int, 2>>& pairs, double distance, std::vector<char>& held) {
  std::vector<char> at(mesh.vertices.size(), 0);
  for (const auto& pair : pairs)
    for (int f : pair)
      for (int v : mesh.faces[f]) at[v] = 1;
  for (int v : band_around(mesh, at, distance).vertices) held[v] = 1;
}

}  // namespace

long finish_seam(Joined& j, double voxel, cut::Cut cut, const SeamSmoothing& smoothing, int threads) {
  const bool thesis = cut == cut::Cut::Thesis;
  tidy_seam(j.mesh, j.seam, j.fixed, j.tag,
            thesis ? SeamTidying{0.2 * voxel, 0.2 * voxel, voxel} : SeamTidying{0.35 * voxel, 1.2 * voxel, voxel});
  for (int v : mesh::split_pinches(j.mesh, j.seam)) j.seam.push_back(j.seam[v]), j.fixed.push_back(j.fixed[v]);
  const std::vector<Vec3> before = j.mesh.vertices;
  part_places(j.mesh, j.seam, j.fixed);
  if (!thesis) even_seam(j.mesh, j.seam, j.fixed, 8);
  const double distance = smoothing.distance > 0 ? smoothing.distance : 2 * voxel;
  const Shape stitched = shape_of(j.mesh);
  constexpr int kHolding = 4;
  std::vector<char> held = j.fixed;
  long crossings = -1;
  Shape best;
  SeamBlend blend;
  // Where surfaces that give way run into each other they do not; then they give way less, or not at all.
  SeamSmoothing less = smoothing;
  for (int attempt = 0; attempt < kHolding + 2 && crossings != 0; ++attempt) {
    if (attempt == kHolding) less.blend_distance = 0.5 * blend.distance;
    if (attempt > kHolding) less.blend = false;
    set_shape(j.mesh, stitched);
    const std::vector<std::array<int, 2>> pairs = smooth_all(j, before, held, voxel, distance, less, threads);
    if (crossings < 0 || long(pairs.size()) < crossings)
      crossings = long(pairs.size()), best = shape_of(j.mesh), blend = j.blend;
    if (j.blend.moved == 0) break;
    hold(j.mesh, pairs, 0.5 * j.blend.distance, held);
  }
  set_shape(j.mesh, best), j.blend = blend;
  mend_normals(j, before);
  return crossings;
}

}  // namespace parts::seam
