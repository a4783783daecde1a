// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/matching.h"

#include <algorithm>
#include <cmath>

#include "parts/base/median.h"
#include "parts/base/parallel.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/loops.h"
#include "parts/spatial/point_tree.h"

namespace parts::mend {
namespace {

double robust(double distance, double spread) {
  const double r = distance / spread;
  return 1 / ((1 + r * r) * (1 + r * r));
}

std::vector<char> faces_near(const Mesh& scan, const Box& near) {
  std::vector<char> flags(scan.faces.size());
  for (int f = 0; f < scan.face_count(); ++f) flags[f] = near.intersects(scan.face_box(f));
  return flags;
}

}  // namespace

FitTarget::FitTarget(const Mesh& scan, const std::vector<char>& flaw, const Box& near, double size)
    : flaw_(flaw), size_(size), center_(near.center()), closest_(scan, faces_near(scan, near)) {
  // Vertices on a border, and two rings of faces around it.
  std::vector<char> beside(scan.vertices.size(), 0), bad(scan.vertices.size(), 0);
  for (const auto& e : mesh::boundary_half_edges(scan)) beside[e[0]] = beside[e[1]] = 1;
  for (int ring = 0; ring < 2; ++ring) {
    std::vector<char> next = beside;
    for (const Triangle& f : scan.faces)
      if (beside[f[0]] || beside[f[1]] || beside[f[2]]) next[f[0]] = next[f[1]] = next[f[2]] = 1;
    beside.swap(next);
  }
  for (int f = 0; f < scan.face_count(); ++f)
    if (flawed(f))
      for (int v : scan.faces[f]) bad[v] = 1;
  Mesh with_normals;
  with_normals.vertices = scan.vertices, with_normals.faces = scan.faces;
  mesh::update_normals(with_normals);
  std::vector<char> border(scan.vertices.size(), 0), used(scan.vertices.size(), 0);
  for (const auto& e : mesh::boundary_half_edges(scan)) border[e[0]] = border[e[1]] = 1;
  for (int f = 0; f < scan.face_count(); ++f) {
    if (!near.intersects(scan.face_box(f))) continue;
    Alike middle{{Vec3::Zero(), Vec3::Zero()}, f, false};
    for (int v : scan.faces[f]) {
      const Vec3 n = with_normals.vertex_normal[v].cast<double>();
      if (!used[v]) points_.push_back({{scan.vertices[v], n}, f, border[v] != 0}), used[v] = 1;
      middle.sample.point += scan.vertices[v] / 3, middle.sample.normal += n;
    }
    middle.sample.normal.normalize();
    points_.push_back(middle);
  }
  for (int v = 0; v < scan.vertex_count(); ++v)
    if (beside[v] && !bad[v] && near.contains(scan.vertices[v]))
      rim_.push_back({scan.vertices[v], with_normals.vertex_normal[v].cast<double>()});
}

std::vector<FitTarget::Alike> FitTarget::most_alike(const std::vector<spatial::Sample>& points, double normals,
                                                    int threads) const {
  using Tree = spatial::PointTree<6>;
  const auto row = [&](const spatial::Sample& s) {
    Tree::Point p;
    for (int d = 0; d < 3; ++d) p[d] = float(s.point[d]), p[3 + d] = float(normals * s.normal[d]);
    return p;
  };
  std::vector<Tree::Point> all;
  all.reserve(points_.size());
  for (const Alike& p : points_) all.push_back(row(p.sample));
  const Tree tree(std::move(all));
  std::vector<Alike> found(points.size());
  parallel_for(long(points.size()), threads, [&](long begin, long end) {
    for (long i = begin; i < end; ++i) found[i] = points_[tree.nearest(row(points[i])).index];
  });
  return found;
}

void Matching::ask_back(const std::vector<Vec3>& at, double farthest, Targets& t) const {
  if (target_.rim().empty()) return;
  Mesh moved;
  moved.vertices = at, moved.faces = model_.faces;
  const double spread = std::max(spread_, first_spread_);
  const spatial::ClosestFace on_model(moved);
  if (on_model.empty()) return;
  std::vector<Vec3> sum(moved.vertices.size(), Vec3::Zero()), normal = sum;
  std::vector<double> weights(moved.vertices.size(), 0);
  int hint = 0;
  for (const spatial::Sample& s : target_.rim()) {
    const spatial::FaceHit hit = on_model(s.point, hint);
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

Targets Matching::operator()(const std::vector<Vec3>& at, double farthest, int stride, double normals) {
  const int n = int(at.size());
  Mesh moved;
  moved.vertices = at, moved.faces = model_.faces;
  mesh::update_normals(moved);
  Targets t{at, std::vector<Vec3>(n, Vec3::Zero()), std::vector<double>(n, 0)};
  std::vector<double> distance(n, -1);
  std::vector<char> over(n, 0), flawed(n, 0);
  parallel_for(n, threads_, [&](long begin, long end) {
    int hint = 0;
    for (long v = begin; v < end; ++v) {
      if (v % stride) continue;
      const spatial::FaceHit hit = target_.closest()(at[v], hint);
      if (hit.on_border || hit.distance > farthest) continue;
      over[v] = 1, flawed[v] = target_.flawed(hit.face);
      if (hit.normal.dot(moved.vertex_normal[v].cast<double>()) < 0.5) continue;
      t.point[v] = hit.point, t.normal[v] = hit.normal, distance[v] = hit.distance;
    }
  });
  if (normals > 0) {
    std::vector<spatial::Sample> asked;
    std::vector<int> vertex;
    for (int v = 0; v < n; ++v)
      if (over[v]) asked.push_back({at[v], moved.vertex_normal[v].cast<double>()}), vertex.push_back(v);
    const std::vector<FitTarget::Alike> alike = target_.most_alike(asked, normals, threads_);
    for (std::size_t i = 0; i < alike.size(); ++i) {
      const int v = vertex[i];
      const Vec3 away = alike[i].sample.point - at[v];
      distance[v] = -1;
      if (alike[i].border || away.norm() > farthest || alike[i].sample.normal.dot(asked[i].normal) < 0.5) continue;
      t.point[v] = alike[i].sample.point, t.normal[v] = alike[i].sample.normal, distance[v] = away.norm();
      flawed[v] = target_.flawed(alike[i].face);
    }
  }
  std::vector<double> found;
  for (int v = 0; v < n; ++v)
    if (distance[v] >= 0 && !flawed[v]) found.push_back(distance[v]);
  if (found.empty()) return t;
  const double spread = robust_ ? std::max(2.5 * median(found), 1e-4 * target_.size()) : 1e3 * farthest;
  spread_ = spread;
  if (first_spread_ == 0) first_spread_ = spread;
  double sum = 0, weights = 0;
  long good = 0;
  for (int v = 0; v < n; ++v) {
    good += over[v] && !flawed[v];
    if (distance[v] < 0 || flawed[v]) continue;
    t.weight[v] = robust(distance[v], spread);
    sum += t.weight[v] * distance[v] * distance[v], weights += t.weight[v];
  }
  t.rms = std::sqrt(sum / weights), t.share = double(found.size()) / double(std::max(1L, good));
  return t;
}

}  // namespace parts::mend
