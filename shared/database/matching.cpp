// SPDX-License-Identifier: GPL-3.0-or-later
#include "database/matching.h"

#include <algorithm>
#include <cmath>

#include "compose/loops.h"
#include "geometry/attributes.h"
#include "geometry/parallel.h"

namespace parts {
namespace {

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + long(v.size() / 2), v.end());
  return v[v.size() / 2];
}

double robust(double distance, double spread) {
  const double r = distance / spread;
  return 1 / ((1 + r * r) * (1 + r * r));
}

}  // namespace

Matching::Matching(const Mesh& model, const Mesh& scan, const std::vector<char>& flaw, double size, int threads)
    : model_(model), flaw_(flaw), closest_(scan), size_(size), threads_(threads) {
  // Vertices on a border, and two rings of faces around it.
  std::vector<char> near(scan.vertices.size(), 0), bad(scan.vertices.size(), 0);
  for (const auto& e : boundary_half_edges(scan)) near[e[0]] = near[e[1]] = 1;
  for (int ring = 0; ring < 2; ++ring) {
    std::vector<char> next = near;
    for (const Triangle& f : scan.faces)
      if (near[f[0]] || near[f[1]] || near[f[2]]) next[f[0]] = next[f[1]] = next[f[2]] = 1;
    near.swap(next);
  }
  for (int f = 0; f < scan.face_count() && !flaw.empty(); ++f)
    if (flaw[f])
      for (int v : scan.faces[f]) bad[v] = 1;
  Mesh with_normals;
  with_normals.vertices = scan.vertices, with_normals.faces = scan.faces;
  update_normals(with_normals);
  const Box box = model.bounds();
  for (int v = 0; v < scan.vertex_count(); ++v)
    if (near[v] && !bad[v] && box.contains(scan.vertices[v]))
      rim_.push_back({scan.vertices[v], with_normals.vertex_normal[v].cast<double>()});
}

void Matching::ask_back(const Mesh& moved, double farthest, double spread, Targets& t) const {
  const ClosestFace on_model(moved);
  if (on_model.empty()) return;
  std::vector<Vec3> sum(moved.vertices.size(), Vec3::Zero()), normal = sum;
  std::vector<double> weights(moved.vertices.size(), 0);
  int hint = 0;
  for (const Sample& s : rim_) {
    const FaceHit hit = on_model(s.point, hint);
    if (hit.on_border || hit.distance > farthest || hit.normal.dot(s.normal) < 0.5) continue;
    const double w = robust(hit.distance, spread);
    for (int k = 0; k < 3; ++k) {
      const int v = moved.faces[hit.face][k];
      if (t.weight[v] > 0) continue;
      sum[v] += w * hit.barycentric[k] * (s.point - hit.point);
      normal[v] += w * hit.barycentric[k] * s.normal;
      weights[v] += w * hit.barycentric[k];
    }
  }
  for (std::size_t v = 0; v < weights.size(); ++v) {
    if (!(weights[v] > 1e-3)) continue;
    t.point[v] = moved.vertices[v] + sum[v] / weights[v];
    t.normal[v] = normal[v].normalized();
    t.weight[v] = std::min(1.0, weights[v]);
  }
}

Targets Matching::operator()(const std::vector<Vec3>& at, double farthest, double flaw_weight) {
  const int n = int(at.size());
  Mesh moved;
  moved.vertices = at, moved.faces = model_.faces;
  update_normals(moved);
  Targets t{at, std::vector<Vec3>(n, Vec3::Zero()), std::vector<double>(n, 0)};
  std::vector<double> distance(n, -1);
  std::vector<char> over(n, 0), flawed(n, 0);
  parallel_for(n, threads_, [&](long begin, long end) {
    int hint = 0;
    for (long v = begin; v < end; ++v) {
      const FaceHit hit = closest_(at[v], hint);
      if (hit.on_border || hit.distance > farthest) continue;
      over[v] = 1, flawed[v] = !flaw_.empty() && flaw_[hit.face];
      if (hit.normal.dot(moved.vertex_normal[v].cast<double>()) < 0.5) continue;
      t.point[v] = hit.point, t.normal[v] = hit.normal, distance[v] = hit.distance;
    }
  });
  std::vector<double> found;
  for (int v = 0; v < n; ++v)
    if (distance[v] >= 0 && !flawed[v]) found.push_back(distance[v]);
  if (found.empty()) return t;
  const double spread = std::max(2.5 * median(found), 1e-4 * size_);
  if (first_spread_ == 0) first_spread_ = spread;
  double sum = 0, weights = 0;
  long good = 0;
  for (int v = 0; v < n; ++v) {
    good += over[v] && !flawed[v];
    if (distance[v] < 0) continue;
    if (flawed[v]) {
      t.weight[v] = flaw_weight * robust(distance[v], first_spread_);
      continue;
    }
    t.weight[v] = robust(distance[v], spread);
    sum += t.weight[v] * distance[v] * distance[v], weights += t.weight[v];
  }
  t.rms = std::sqrt(sum / weights), t.share = double(found.size()) / double(std::max(1L, good));
  ask_back(moved, farthest, std::max(spread, first_spread_), t);
  return t;
}

}  // namespace parts
