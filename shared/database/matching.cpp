// SPDX-License-Identifier: GPL-3.0-or-later
#include "database/matching.h"

#include <algorithm>
#include <cmath>

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
  return t;
}

}  // namespace parts
