// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/align/symmetry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "parts/align/icp.h"
#include "parts/base/parallel.h"
#include "parts/base/tasks.h"
#include "parts/spatial/closest_face.h"
#include "parts/spatial/surface.h"

namespace parts::align {
namespace {

using spatial::Sample;

constexpr int kSamples = 2000, kGridSamples = 6000, kGridCells = 48;
constexpr int kDirections = 64;   // over half a sphere: about 11 degrees from any to the next
constexpr int kRefined = 12;      // of the coarse planes
constexpr double kApart = 0.966;  // cosine of 15 degrees

/// A plane in the surface's frame, where its size is 1.
struct Plane {
  Vec3 normal = Vec3::UnitX();
  double offset = 0;  ///< normal . p
  double score = 0;

  Vec3 mirrored(const Vec3& p) const { return p - 2 * (normal.dot(p) - offset) * normal; }
  Vec3 turned(const Vec3& n) const { return n - 2 * normal.dot(n) * normal; }
  bool is_like(const Plane& o) const {
    return std::abs(normal.dot(o.normal)) > kApart &&
           std::abs(offset - (normal.dot(o.normal) < 0 ? -1 : 1) * o.offset) < 0.3;
  }
};

/// The reflection nearest to a reflection that was turned and moved a little.
Plane nearest_reflection(const Plane& start, const Pose& moved) {
  Eigen::Matrix3d linear;
  for (int d = 0; d < 3; ++d) linear.col(d) = moved.rotation * start.turned(Vec3::Unit(d));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes((linear + linear.transpose()) / 2);
  Plane p;
  p.normal = axes.eigenvectors().col(0);  // of the eigenvalue nearest to -1
  p.offset = p.normal.dot(moved(start.mirrored(Vec3::Zero()))) / 2;
  return p;
}

class Finder {
 public:
  Finder(const Mesh& mesh, const std::vector<char>& flags)
      : surface_(spatial::make_surface(mesh, flags, "scanned")),
        tree_(surface_),
        grid_(spatial::sample_surface(surface_, kGridSamples), kGridCells),
        samples_(spatial::sample_surface(surface_, kSamples)),
        closest_(mesh, flags) {}

  std::vector<Plane> starts() const;
  /// Lays the surface on its reflection. @param exact  on the triangles, not on the grid's samples
  Plane refined(Plane plane, bool exact, const Poll& poll) const;
  Symmetry measured(const Plane& plane) const;

 private:
  const spatial::Surface surface_;
  const spatial::TriangleTree tree_;
  const spatial::ClosestSampleGrid grid_;
  const std::vector<Sample> samples_;
  const spatial::ClosestFace closest_;
};

std::vector<Plane> Finder::starts() const {
  std::vector<Plane> planes;
  const Eigen::Matrix3d axes = spatial::principal_axes(surface_.covariance);
  for (int a = 0; a < 3; ++a) {
    planes.push_back({axes.col(a)});
    for (double side : {-1.0, 1.0}) planes.push_back({(axes.col(a) + side * axes.col((a + 1) % 3)).normalized()});
  }
  for (int i = 0; i < kDirections; ++i) {  // a spiral
    const double z = (i + 0.5) / kDirections, turn = 2.399963229728653 * i;
    const Vec3 n(std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z);
    planes.push_back({axes * n});
  }
  return planes;
}

Plane Finder::refined(Plane plane, bool exact, const Poll& poll) const {
  const spatial::ClosestPoint& fixed = exact ? static_cast<const spatial::ClosestPoint&>(tree_) : grid_;
  IcpOptions options;
  options.samples = exact ? 1000 : 300;
  options.iterations = exact ? 20 : 12;
  options.overlap = kSymmetric;
  options.done = 1e-5;
  for (int round = 0; round < (exact ? 3 : 1); ++round) {
    std::vector<Sample> reflected(samples_.begin(), samples_.begin() + options.samples);
    for (Sample& s : reflected) s = {plane.mirrored(s.point), plane.turned(s.normal)};
    const IcpResult laid = icp(reflected, fixed, Pose{}, options, poll);
    plane = nearest_reflection(plane, laid.pose);
  }
  std::vector<Sample> reflected(samples_.begin(), samples_.begin() + options.samples);
  for (Sample& s : reflected) s = {plane.mirrored(s.point), plane.turned(s.normal)};
  plane.score = PoseScore(reflected, options.samples, kSymmetric, fixed)(Pose{});
  return plane;
}

Symmetry Finder::measured(const Plane& plane) const {
  Symmetry s;
  s.normal = plane.normal, s.size = surface_.size;
  s.point = surface_.origin + surface_.size * plane.offset * plane.normal;
  std::vector<double> squares;
  int hint = 0;
  for (const Sample& sample : samples_) {
    const Vec3 p = surface_.origin + surface_.size * plane.mirrored(sample.point);
    const spatial::FaceHit hit = closest_(p, hint);
    if (!hit.on_border) squares.push_back(hit.distance * hit.distance);
  }
  // Where most of the reflection lies beyond the borders, it shows nothing.
  if (squares.size() < samples_.size() / 4) {
    s.residual = s.size;
    return s;
  }
  const std::size_t kept = std::size_t(kSymmetric * double(squares.size()));
  std::nth_element(squares.begin(), squares.begin() + long(kept), squares.end());
  double sum = 0;
  for (std::size_t i = 0; i < kept; ++i) sum += squares[i];
  s.residual = std::sqrt(sum / double(kept));
  return s;
}

void keep_different(std::vector<Plane>& planes, std::size_t most) {
  std::stable_sort(planes.begin(), planes.end(), [](const Plane& a, const Plane& b) { return a.score < b.score; });
  std::vector<Plane> kept;
  for (const Plane& p : planes)
    if (kept.size() < most &&
        std::none_of(kept.begin(), kept.end(), [&](const Plane& other) { return p.is_like(other); }))
      kept.push_back(p);
  planes = std::move(kept);
}

}  // namespace

Eigen::Affine3d Symmetry::reflection() const {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() -= 2 * normal * normal.transpose();
  map.translation() = 2 * normal.dot(point) * normal;
  return map;
}

std::vector<Symmetry> find_symmetries(const Mesh& mesh, const std::vector<char>& flags, int most, int threads,
                                      Progress& progress) {
  const Finder finder(mesh, flags);
  std::vector<Plane> planes = finder.starts();
  const int all = thread_count(threads);
  for (bool exact : {false, true}) {
    run_tasks(int(planes.size()), all, progress,
              [&](int i, const Poll& poll) { planes[i] = finder.refined(planes[i], exact, poll); });
    keep_different(planes, std::size_t(exact ? most : kRefined));
  }
  std::vector<Symmetry> found;
  for (const Plane& p : planes) found.push_back(finder.measured(p));
  std::stable_sort(found.begin(), found.end(),
                   [](const Symmetry& a, const Symmetry& b) { return a.residual < b.residual; });
  return found;
}

}  // namespace parts::align
