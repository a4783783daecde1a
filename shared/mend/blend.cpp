// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/blend.h"

#include <algorithm>
#include <cmath>

#include "parts/base/parallel.h"
#include "parts/base/tasks.h"
#include "parts/mend/fit_to_rim.h"
#include "parts/mend/shape_prior.h"

namespace parts::mend {
namespace {

/// The base in the shape of each other model it could be brought onto.
std::vector<std::vector<Vec3>> shapes_of(const std::vector<PosedModel>& models, double size, int threads,
                                         std::vector<double>& weight, Progress& progress) {
  Mesh base;
  base.vertices = models[0].fitted, base.faces = models[0].mesh.faces;
  const int others = int(models.size()) - 1;
  std::vector<std::vector<Vec3>> shapes(models.size());
  shapes[0] = models[0].mesh.vertices;
  FitOptions fit;
  fit.rigid = fit.robust = false;
  fit.threads = 1;
  run_tasks(others, thread_count(threads), progress, [&](int other, const Poll&) {
    const PosedModel& model = models[std::size_t(other) + 1];
    Mesh mesh;
    mesh.vertices = model.fitted, mesh.faces = model.mesh.faces;
    const std::vector<char> whole;
    const FitTarget there(mesh, whole, mesh.bounds(), size);
    Progress silent;
    const Fitted onto = fit_to_rim(base, there, fit, silent);
    if (!(onto.share > 0.6 && onto.rms_after < 0.05 * size)) return;
    std::vector<Vec3>& shape = shapes[std::size_t(other) + 1];
    shape = onto.vertices;
    int hint = 0;
    for (Vec3& p : shape) {
      const spatial::FaceHit hit = there.closest()(p, hint);
      for (int k = 0; k < 3; ++k) {
        const int v = mesh.faces[hit.face][k];
        p += hit.barycentric[k] * (model.mesh.vertices[v] - model.fitted[v]);
      }
    }
  });
  double sum = 0;
  for (std::size_t i = 0; i < models.size(); ++i)
    if (!shapes[i].empty()) weight.push_back(std::pow(std::max(models[i].rms, 1e-4 * size), -2)), sum += weight.back();
  for (double& w : weight) w /= sum;
  shapes.erase(std::remove_if(shapes.begin(), shapes.end(), [](const auto& s) { return s.empty(); }), shapes.end());
  return shapes;
}

/// So many of the vertices that are flagged, spread over the surface, denser near the centre.
std::vector<int> spread(const std::vector<Vec3>& points, const std::vector<char>& flags, const FitTarget& target,
                        int count) {
  const int n = int(points.size());
  std::vector<double> reach(n), away(n, 1e300);
  for (int v = 0; v < n; ++v) reach[v] = 0.3 * target.size() + (points[v] - target.center()).norm();
  std::vector<int> chosen;
  int next = -1;
  for (int v = 0; v < n; ++v)
    if (flags[v] && (next < 0 || reach[v] < reach[next])) next = v;
  while (next >= 0 && int(chosen.size()) < count) {
    chosen.push_back(next);
    const Vec3 last = points[next];
    double farthest = 0;
    next = -1;
    for (int v = 0; v < n; ++v) {
      if (!flags[v]) continue;
      away[v] = std::min(away[v], (points[v] - last).norm());
      if (const double d = away[v] / reach[v]; d > farthest) farthest = d, next = v;
    }
  }
  return chosen;
}

constexpr double kNoise = 0.005;  // of the size: how well a scan is known

/// What the good surface of a scan tells of a shape near it.
std::vector<PlaneObservation> seen_on(const std::vector<Vec3>& now, const Targets& targets, const FitTarget& target) {
  constexpr int kMost = 600;  // more of the same say nothing new
  std::vector<char> matched;
  for (double w : targets.weight) matched.push_back(w > 0.1);
  std::vector<PlaneObservation> seen;
  for (int v : spread(now, matched, target, kMost))
    seen.push_back({v, targets.point[v], targets.normal[v], kNoise * target.size() / std::sqrt(targets.weight[v])});
  return seen;
}

}  // namespace

Blended blend_models(const std::vector<PosedModel>& models, const FitTarget& target, int threads, Progress& progress) {
  const Mesh& base = models[0].mesh;
  Blended out{base.vertices, 1};
  std::vector<double> weight;
  progress.stage("Bringing the models onto each other", 50, 90);
  const std::vector<std::vector<Vec3>> shapes = shapes_of(models, target.size(), threads, weight, progress);
  progress.stage("Blending the models", 90, 100);
  if (shapes.size() < 2) return out;
  out.models = int(shapes.size());
  const ShapePrior prior(shapes, weight, target.size());
  Matching match(base, target, true, threads);
  out.vertices = prior.mean();
  constexpr int kRounds = 6;
  for (int round = 0; round < kRounds; ++round) {
    progress.at(double(round) / kRounds);
    const Targets targets = match(out.vertices, 0.25 * target.size(), 1, kAlike * target.size());
    const std::vector<PlaneObservation> seen = seen_on(out.vertices, targets, target);
    if (seen.empty()) break;
    out.vertices = prior.given(seen);
  }
  progress.at(1);
  return out;
}

}  // namespace parts::mend
