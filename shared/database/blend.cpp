// SPDX-License-Identifier: GPL-3.0-or-later
#include "database/blend.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "database/fit_to_rim.h"
#include "geometry/parallel.h"

namespace parts {
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
  // In bands of the cores, so that cancelling waits for one band only.
  const int band = thread_count(threads);
  for (int first = 0; first < others; first += band) {
    progress.at(0.4 + 0.5 * first / others);
    parallel_for(std::min(band, others - first), threads, [&](long begin, long end) {
      for (long i = first + begin + 1; i < first + end + 1; ++i) {
        Progress silent;
        Mesh other;
        other.vertices = models[i].fitted, other.faces = models[i].mesh.faces;
        const std::vector<char> whole;
        const FitTarget there(other, whole, other.bounds(), size);
        const Fitted onto = fit_to_rim(base, there, fit, silent);
        if (!(onto.share > 0.6 && onto.rms_after < 0.05 * size)) continue;
        shapes[i] = onto.vertices;
        int hint = 0;
        for (Vec3& p : shapes[i]) {
          const FaceHit hit = there.closest()(p, hint);
          for (int k = 0; k < 3; ++k) {
            const int v = other.faces[hit.face][k];
            p += hit.barycentric[k] * (models[i].mesh.vertices[v] - models[i].fitted[v]);
          }
        }
      }
    });
  }
  double sum = 0;
  for (std::size_t i = 0; i < models.size(); ++i)
    if (!shapes[i].empty()) weight.push_back(std::pow(std::max(models[i].rms, 1e-4 * size), -4)), sum += weight.back();
  for (double& w : weight) w /= sum;
  shapes.erase(std::remove_if(shapes.begin(), shapes.end(), [](const auto& s) { return s.empty(); }), shapes.end());
  return shapes;
}

}  // namespace

Blended blend_models(const std::vector<PosedModel>& models, const FitTarget& target, int threads, Progress& progress) {
  const double size = target.size();
  const Mesh& base = models[0].mesh;
  Blended out{base.vertices, 1};
  std::vector<double> weight;
  const std::vector<std::vector<Vec3>> shapes = shapes_of(models, size, threads, weight, progress);
  const int n = base.vertex_count(), k = int(shapes.size());
  if (k < 2) return out;
  out.models = k;
  std::vector<Vec3> mean(n, Vec3::Zero());
  for (int i = 0; i < k; ++i)
    for (int v = 0; v < n; ++v) mean[v] += weight[i] * shapes[i][v];

  Matching match(base, target, true, threads);
  std::vector<Vec3> now = mean;
  constexpr int kRounds = 6;
  constexpr double kNoise = 0.02;  // of the size: what no blend of the models explains
  constexpr double kObservations = 100;
  for (int round = 0; round < kRounds; ++round) {
    progress.at(0.9 + 0.1 * round / kRounds);
    const Targets t = match(now, 0.25 * size, 0);
    double sum = 0;
    for (double w : t.weight) sum += w;
    if (!(sum > 0)) break;
    // Vertices beside each other say the same: they count as so many independent ones.
    const double scale = kObservations / sum / std::pow(kNoise * size, 2);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(k, k);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(k), row(k);
    for (int v = 0; v < n; ++v) {
      if (!(t.weight[v] > 0)) continue;
      for (int i = 0; i < k; ++i) row[i] = (shapes[i][v] - mean[v]).dot(t.normal[v]) * std::sqrt(weight[i]);
      const double w = scale * t.weight[v];
      normal.selfadjointView<Eigen::Lower>().rankUpdate(row, w);
      right += w * (t.point[v] - mean[v]).dot(t.normal[v]) * row;
    }
    const Eigen::VectorXd c = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    for (int v = 0; v < n; ++v) {
      now[v] = mean[v];
      for (int i = 0; i < k; ++i) now[v] += c[i] * std::sqrt(weight[i]) * (shapes[i][v] - mean[v]);
    }
  }
  out.vertices = std::move(now);
  progress.at(1);
  return out;
}

}  // namespace parts
