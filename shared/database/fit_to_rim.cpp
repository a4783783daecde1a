// SPDX-License-Identifier: GPL-3.0-or-later
#include "database/fit_to_rim.h"

#include <Eigen/SVD>

#include "database/closest_face.h"
#include "database/smooth_field.h"
#include "geometry/attributes.h"
#include "geometry/parallel.h"

namespace parts {
namespace {

/// Where the model's vertices should go, and how much each is to be believed.
struct Targets {
  std::vector<Vec3> point;
  std::vector<double> weight;
  double rms = 0, share = 0;
};

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + v.size() / 2, v.end());
  return v[v.size() / 2];
}

class Matcher {
 public:
  Matcher(const Mesh& model, const Mesh& scan, const std::vector<char>& flaw, double size, int threads)
      : model_(model), flaw_(flaw), closest_(scan), size_(size), threads_(threads) {}

  bool empty() const { return closest_.empty(); }

  /// Pairs farther apart than `farthest`, on the scan's border or on a side
  /// that faces away are none; of the rest, those that are out of line count less.
  /// @param flaw_weight  of what lies on damaged faces
  Targets operator()(const std::vector<Vec3>& at, double farthest, double flaw_weight) const {
    const int n = int(at.size());
    Mesh moved;
    moved.vertices = at, moved.faces = model_.faces;
    update_normals(moved);
    Targets t{at, std::vector<double>(n, 0)};
    std::vector<double> distance(n, -1);
    std::vector<char> faces_scan(n, 0), flawed(n, 0);
    parallel_for(n, threads_, [&](long begin, long end) {
      int hint = 0;
      for (long v = begin; v < end; ++v) {
        const FaceHit hit = closest_(at[v], hint);
        if (hit.on_border || hit.distance > farthest) continue;
        faces_scan[v] = 1, flawed[v] = !flaw_.empty() && flaw_[hit.face];
        if (hit.normal.dot(moved.vertex_normal[v].cast<double>()) < 0.5) continue;
        t.point[v] = hit.point, distance[v] = hit.distance;
      }
    });
    std::vector<double> found;
    for (int v = 0; v < n; ++v)
      if (distance[v] >= 0 && !flawed[v]) found.push_back(distance[v]);
    if (found.empty()) return t;
    const double spread = std::max(2.5 * median(found), 1e-4 * size_);
    double sum = 0, weights = 0;
    long facing = 0;
    for (int v = 0; v < n; ++v) {
      facing += faces_scan[v] && !flawed[v];
      if (distance[v] < 0) continue;
      const double r = distance[v] / (flawed[v] ? std::max(spread, 0.1 * size_) : spread);
      t.weight[v] = 1 / ((1 + r * r) * (1 + r * r));  // Geman and McClure
      if (flawed[v]) {
        t.weight[v] *= flaw_weight;
        continue;
      }
      sum += t.weight[v] * distance[v] * distance[v], weights += t.weight[v];
    }
    t.rms = std::sqrt(sum / weights), t.share = double(found.size()) / double(facing);
    return t;
  }

 private:
  const Mesh& model_;
  const std::vector<char>& flaw_;
  ClosestFace closest_;
  double size_;
  int threads_;
};

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

Fitted fit_to_rim(const Mesh& model, const Mesh& scan, const std::vector<char>& flaw, const FitOptions& options,
                  Progress& progress) {
  Fitted fitted;
  fitted.vertices = model.vertices;
  const double size = options.size > 0 ? options.size : model.bounds().diagonal().norm() / 2;
  const Matcher match(model, scan, flaw, size, options.threads);
  if (match.empty() || model.faces.empty()) return fitted;

  constexpr double kFlawRigid = 0.25, kFlawLength = 0.3;
  Targets targets = match(fitted.vertices, 0.5 * size, kFlawRigid);
  fitted.rms_before = targets.rms, fitted.share = targets.share;
  constexpr int kRigidSteps = 20;
  for (int step = 0; options.rigid && step < kRigidSteps; ++step) {
    progress.at(0.3 * step / kRigidSteps);
    apply_similarity(fitted.vertices, targets, options.scale && step >= kRigidSteps / 4);
    targets = match(fitted.vertices, 0.5 * size, kFlawRigid);
  }
  if (options.smooth) {
    Mesh start;
    start.vertices = fitted.vertices, start.faces = model.faces;
    SmoothField field(start);
    // From the whole region's size down to its details.
    const std::vector<double> lengths{1, 1, 0.5, 0.5, 0.25, 0.25, 0.12, 0.12, 0.06, 0.06};
    for (std::size_t step = 0; step < lengths.size(); ++step) {
      progress.at(0.3 + 0.7 * double(step) / double(lengths.size()));
      std::vector<Vec3> wanted(start.vertices.size());
      for (std::size_t v = 0; v < wanted.size(); ++v) wanted[v] = targets.point[v] - start.vertices[v];
      const std::vector<Vec3> u = field(wanted, targets.weight, lengths[step] * size * 0.5);
      double moved = 0;
      for (std::size_t v = 0; v < u.size(); ++v)
        fitted.vertices[v] = start.vertices[v] + u[v], moved += u[v].squaredNorm();
      fitted.moved = std::sqrt(moved / double(u.size()));
      // Data of weight w are smoothed over length / w^(1/4): flaws count for their coarse shape only.
      const double next = lengths[std::min(step + 1, lengths.size() - 1)];
      targets = match(fitted.vertices, std::max(0.1, 0.5 * lengths[step]) * size,
                      std::min(1.0, std::pow(next / kFlawLength, 4)));
    }
  }
  fitted.rms_after = targets.rms, fitted.share = targets.share;
  progress.at(1);
  return fitted;
}

}  // namespace parts
