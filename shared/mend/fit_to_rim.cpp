// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/fit_to_rim.h"

#include <Eigen/SVD>
#include <algorithm>

#include "parts/mend/smooth_field.h"

namespace parts::mend {
namespace {

/// The similarity that takes `from` nearest to the targets (Umeyama 1991, weighted).
void apply_similarity(std::vector<Vec3>& from, const Targets& to, bool scale) {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  double sum = 0;
  for (std::size_t v = 0; v < from.size(); ++v)
    a += to.weight[v] * from[v], b += to.weight[v] * to.point[v], sum += to.weight[v];
  if (!(sum > 0)) return;
  a /= sum, b /= sum;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double spread = 0;
  for (std::size_t v = 0; v < from.size(); ++v)
    covariance += to.weight[v] * (to.point[v] - b) * (from[v] - a).transpose(),
        spread += to.weight[v] * (from[v] - a).squaredNorm();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  const Eigen::Matrix3d rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  const double s = scale && spread > 0 ? svd.singularValues().dot(sign) / spread : 1;
  for (Vec3& p : from) p = b + s * (rotation * (p - a));
}

}  // namespace

Fitted fit_to_rim(const Mesh& model, const FitTarget& target, const FitOptions& options, Progress& progress) {
  Fitted fitted;
  fitted.vertices = model.vertices;
  const double size = target.size();
  if (target.empty() || model.faces.empty()) return fitted;

  Matching match(model, target, options.robust, options.threads);
  constexpr int kRigidSteps = 20, kRigidVertices = 800, kCoarseVertices = 1500, kFineVertices = 4000;
  const auto stride_for = [&](int vertices) { return std::max(1, model.vertex_count() / vertices); };
  const int stride = options.rigid ? stride_for(kRigidVertices) : 1;
  Targets targets = match(fitted.vertices, 0.5 * size, stride);
  fitted.rms_before = targets.rms, fitted.share = targets.share;
  for (int step = 0; options.rigid && step < kRigidSteps; ++step) {
    progress.at(0.3 * step / kRigidSteps);
    const std::vector<Vec3> before = fitted.vertices;
    apply_similarity(fitted.vertices, targets, options.scale && step >= kRigidSteps / 4);
    double moved = 0;
    for (std::size_t v = 0; v < before.size(); ++v) moved = std::max(moved, (fitted.vertices[v] - before[v]).norm());
    const bool last = step + 1 == kRigidSteps || (step > kRigidSteps / 4 && moved < 1e-3 * size);
    targets = match(fitted.vertices, 0.5 * size, last ? 1 : stride);
    if (last) break;
  }
  if (options.smooth) {
    match.ask_back(fitted.vertices, 0.5 * size, targets);
    Mesh start;
    start.vertices = fitted.vertices, start.faces = model.faces;
    SmoothField field(start);
    // From the whole region's size down to its details.
    std::vector<double> lengths;
    for (double l : {0.7, 0.25, 0.08})
      if (l >= options.finest) lengths.push_back(l);
    for (std::size_t step = 0; step < lengths.size(); ++step) {
      progress.at(0.3 + 0.7 * double(step) / double(lengths.size()));
      std::vector<Vec3> wanted(start.vertices.size());
      for (std::size_t v = 0; v < wanted.size(); ++v) wanted[v] = targets.point[v] - start.vertices[v];
      const std::vector<Vec3> u = field(wanted, targets.weight, lengths[step] * size * 0.5);
      // A surface too degenerate to be solved on stays as it is.
      if (!std::all_of(u.begin(), u.end(), [](const Vec3& d) { return d.allFinite(); })) break;
      double moved = 0;
      for (std::size_t v = 0; v < u.size(); ++v)
        fitted.vertices[v] = start.vertices[v] + u[v], moved += u[v].squaredNorm();
      fitted.moved = std::sqrt(moved / double(u.size()));
      const double farthest = std::max(0.1, 0.5 * lengths[step]) * size;
      const int few = stride_for(step + 2 < lengths.size() ? kCoarseVertices : kFineVertices);
      const double normals = step + 1 < lengths.size() ? kAlike * size : 0;
      targets = match(fitted.vertices, farthest, few, normals);
      for (double& w : targets.weight) w *= few;  // for the vertices that were left out
      match.ask_back(fitted.vertices, farthest, targets);
    }
  }
  fitted.rms_after = targets.rms, fitted.share = targets.share;
  progress.at(1);
  return fitted;
}

}  // namespace parts::mend
