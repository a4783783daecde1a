// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mesh/prepare.h"
#include "parts/seam/joined.h"
#include "unit/compose_support.h"

namespace parts::test {

/// A surface over a grid of n x m quads; `at` maps [0, 1] x [0, 1] to space.
/// Where wrapped, the first parameter comes round.
inline Mesh patch(int n, int m, bool wrapped, const std::function<Vec3(double, double)>& at) {
  Mesh mesh;
  const int across = wrapped ? n : n + 1;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i < across; ++i) mesh.vertices.push_back(at(double(i) / n, double(j) / m));
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * across + i, b = j * across + (i + 1) % across, c = a + across, d = b + across;
      if ((i + j) % 2)
        mesh.faces.push_back({a, b, c}), mesh.faces.push_back({b, d, c});
      else
        mesh.faces.push_back({a, b, d}), mesh.faces.push_back({a, d, c});
    }
  return mesh;
}

/// Takes out the faces that pass, and what they leave unused.
inline Mesh without(const Mesh& mesh, const std::function<bool(const Vec3&)>& pass) {
  std::vector<char> keep = faces_where(mesh, pass);
  for (char& k : keep) k = !k;
  Mesh out;
  std::vector<int> number(mesh.vertices.size(), -1);
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!keep[f]) continue;
    out.faces.push_back(mesh.faces[f]);
    for (int& v : out.faces.back()) {
      if (number[v] < 0) number[v] = out.vertex_count(), out.vertices.push_back(mesh.vertices[v]);
      v = number[v];
    }
  }
  return out;
}

inline cut::Model model_of(const Mesh& mesh) {
  cut::Model m;
  m.name = "a model";
  m.prepared = mesh::prepare(mesh);
  m.keep.assign(m.prepared.mesh.faces.size(), 0);
  return m;
}

/// A clip that keeps what lies where the value is positive.
inline seam::Clipped clip_by(const cut::Model& model, const std::function<double(const Vec3&)>& value,
                             double max_edge = 1e9) {
  seam::ClipField field;
  field.value = value;
  field.crosses = [=](const Mesh& m, int f) {
    double low = 1e300, high = -1e300;
    for (int k = 0; k < 3; ++k) {
      const double v = value(m.corner(f, k));
      low = std::min(low, v), high = std::max(high, v);
    }
    return low <= 0 && high >= 0;
  };
  field.max_edge = max_edge;
  return seam::clip(model.prepared.mesh, std::vector<signed char>(model.prepared.mesh.faces.size(), 0), field, 1);
}

/// What a reader sees that makes vertices at one place one.
inline mesh::MeshCheck welded_check(const Mesh& mesh) {
  Mesh welded = mesh;
  const std::vector<int> first = mesh::first_at_same_place(mesh);
  welded.faces.clear();
  for (Triangle f : mesh.faces) {
    for (int& v : f) v = first[v];
    if (f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) welded.faces.push_back(f);
  }
  return mesh::check(welded);
}

struct Stitched {
  seam::Joined joined;
  seam::SeamReport report;
  double unmatched = 0;
  const Mesh& mesh() const { return joined.mesh; }
};

/// Both models clipped, joined and stitched; finished if an edge length is given.
inline Stitched stitched(const cut::Model& a, const seam::Clipped& ca, const cut::Model& b, const seam::Clipped& cb,
                         double max_gap, double finish = 0, const seam::SeamSmoothing& smoothing = {}) {
  Stitched s;
  s.joined = seam::join_parts(a, ca, b, cb);
  s.unmatched = seam::stitch_parts(s.joined, max_gap, s.report);
  if (finish > 0) seam::finish_seam(s.joined, finish, cut::Cut::Mesh, smoothing, 1);
  return s;
}

}  // namespace parts::test
