// SPDX-License-Identifier: GPL-3.0-or-later
#include "database/blend.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "database/fit_to_rim.h"
#include "database/matching.h"
#include "geometry/attributes.h"
#include "geometry/parallel.h"

namespace parts {
namespace {

/// The base in the shape of each other model it could be brought onto.
std::vector<std::vector<Vec3>> shapes_of(const Mesh& base, const std::vector<Mesh>& others, const BlendOptions& options,
                                         Progress& progress) {
  std::vector<Fitted> fitted(others.size());
  FitOptions fit;
  fit.size = options.size;
  fit.rigid = false;
  fit.finest = 0.12;
  fit.threads = 1;
  // In bands of the cores, so that cancelling waits for one band only.
  const int band = thread_count(options.threads);
  for (std::size_t first = 0; first < others.size(); first += std::size_t(band)) {
    progress.at(0.9 * double(first) / double(others.size()));
    const long count = std::min<long>(band, long(others.size() - first));
    parallel_for(count, options.threads, [&](long begin, long end) {
      for (long i = begin; i < end; ++i) {
        Progress silent;
        fitted[first + std::size_t(i)] = fit_to_rim(base, others[first + std::size_t(i)], {}, fit, silent);
      }
    });
  }
  std::vector<std::vector<Vec3>> shapes;
  for (const Fitted& f : fitted)
    if (f.share > 0.6 && f.rms_after < 0.05 * options.size) shapes.push_back(f.vertices);
  return shapes;
}

}  // namespace

Blended blend_models(const Mesh& base, const std::vector<Mesh>& others, const Mesh& scan, const std::vector<char>& flaw,
                     const BlendOptions& options, Progress& progress) {
  Blended out{base.vertices, 1};
  std::vector<std::vector<Vec3>> shapes = shapes_of(base, others, options, progress);
  if (shapes.empty()) return out;
  shapes.push_back(base.vertices);
  const int n = base.vertex_count(), k = int(shapes.size());
  out.models = k;
  std::vector<Vec3> mean(n, Vec3::Zero());
  for (const auto& s : shapes)
    for (int v = 0; v < n; ++v) mean[v] += s[v] / k;

  Matching match(base, scan, flaw, options.size, options.threads);
  std::vector<Vec3> now = mean;
  constexpr int kRounds = 6;
  constexpr double kNoise = 0.02;  // of the size: what no blend of the models explains
  constexpr double kObservations = 100;
  for (int round = 0; round < kRounds; ++round) {
    progress.at(0.9 + 0.1 * round / kRounds);
    const Targets t = match(now, 0.25 * options.size, 1);
    double sum = 0;
    for (double w : t.weight) sum += w;
    if (!(sum > 0)) break;
    // Vertices beside each other say the same: they count as so many independent ones.
    const double scale = kObservations / sum / std::pow(kNoise * options.size, 2);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(k, k);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(k), row(k);
    for (int v = 0; v < n; ++v) {
      if (!(t.weight[v] > 0)) continue;
      for (int i = 0; i < k; ++i) row[i] = (shapes[i][v] - mean[v]).dot(t.normal[v]) / std::sqrt(double(k - 1));
      const double w = scale * t.weight[v];
      normal.selfadjointView<Eigen::Lower>().rankUpdate(row, w);
      right += w * (t.point[v] - mean[v]).dot(t.normal[v]) * row;
    }
    const Eigen::VectorXd c = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right) / std::sqrt(double(k - 1));
    for (int v = 0; v < n; ++v) {
      now[v] = mean[v];
      for (int i = 0; i < k; ++i) now[v] += c[i] * (shapes[i][v] - mean[v]);
    }
  }
  out.vertices = std::move(now);
  progress.at(1);
  return out;
}

}  // namespace parts
