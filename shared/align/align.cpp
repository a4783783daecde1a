// SPDX-License-Identifier: GPL-3.0-or-later
#include "align/align.h"

#include <algorithm>
#include <cstdio>

#include "align/closest_point.h"
#include "align/coarse_poses.h"
#include "align/icp.h"
#include "align/surface.h"
#include "align/tasks.h"
#include "geometry/parallel.h"

namespace parts {
namespace {

// A level of the search: each takes more samples and keeps fewer poses.
struct Level {
  int samples, iterations, kept;
  double sliding;
  bool exact;      ///< on the triangles, not on the grid of samples
  bool may_scale;  ///< far from the answer a free scale only shrinks
};
constexpr int kScoreSamples = 64;
constexpr int kScored = 320;
constexpr Level kLevels[] = {{100, 6, 64, 0.3, false, false}, {250, 12, 10, 0.2, false, true}, {600, 20, 2, 0.1, true, true}};
constexpr int kFinalSamples = 3000;
constexpr int kGridSamples = 6000, kGridCells = 48;

// Poses whose residuals differ by less than this are equally good: the one that moves the model least is taken.
constexpr double kTie = 0.02;
// A mirror image must be clearly better than the model as it is: most things are nearly symmetric.
constexpr double kMirrorHandicap = 1.15;

const double REV = getenv("REV") ? atof(getenv("REV")) : 1;
const double FREE = getenv("FREE") ? atof(getenv("FREE")) : 0.5;
const double FREEMIN = getenv("FREEMIN") ? atof(getenv("FREEMIN")) : 600;
class Search {
 public:
  Search(const Surface& moving, const Surface& fixed, const AlignOptions& options, Progress& progress)
      : options_(options),
        progress_(progress),
        threads_(thread_count(options.threads)),
        moving_(moving),
        fixed_(fixed),
        unit_scale_(moving.size / fixed.size),
        moving_tree_(moving),
        tree_(fixed) {
    samples_[0] = samples_[1] = sample_surface(moving, kFinalSamples);
    fixed_samples_[0] = fixed_samples_[1] = sample_surface(fixed, kFinalSamples);
    for (std::vector<Sample>* mirrored : {&samples_[1], &fixed_samples_[1]})
      for (Sample& s : *mirrored) s.point[0] *= -1, s.normal[0] *= -1;
  }

  AlignResult run();

 private:
  struct Candidate {
    Pose pose;
    double score = 0;
    bool keep = false;  ///< whatever its score
    int iterations = 0;
  };

  Pose current() const {
    Pose p;
    p.scale = unit_scale_;
    p.translation = (moving_.origin - fixed_.origin) / fixed_.size;
    return p;
  }
  std::vector<double> start_scales() const;
  std::vector<Candidate> coarse() const;
  double reverse_score(const Pose& pose, const ClosestPoint& moving, int samples) const;
  void score(std::vector<Candidate>& candidates, const ClosestPoint& moving, const ClosestPoint& fixed, int samples);
  void refine(std::vector<Candidate>& candidates, const ClosestPoint& moving, const ClosestPoint& fixed, const IcpOptions& icp_options);
  void keep_best(std::vector<Candidate>& candidates, int count, double spacing) const;
  double rank(const Candidate& c) const { return c.score * (c.pose.mirrored ? kMirrorHandicap : 1); }
  double motion(const Pose& p) const;
  const Candidate& choose(const std::vector<Candidate>& candidates) const;
  std::vector<double> distances(const Pose& pose) const;
  double trimmed_rms(std::vector<double> d) const;
  Eigen::Matrix4d world_matrix(const Pose& pose) const;

  const AlignOptions& options_;
  Progress& progress_;
  int threads_;
  const Surface &moving_, &fixed_;
  double unit_scale_;  ///< of the moving frame in the fixed one where world lengths are kept
  TriangleTree moving_tree_, tree_;
  std::vector<Sample> samples_[2], fixed_samples_[2];  ///< as they are, mirrored
};

std::vector<double> Search::start_scales() const {
  if (!options_.allow_scale) return {unit_scale_};
  // Both surfaces have RMS radius 1: for two wholes 1 is the scale. A part of one of them is smaller.
  std::vector<double> scales{1.0, 0.7, 1.4};
  bool near = false;
  for (double s : scales) near |= std::abs(std::log(s / unit_scale_)) < 0.15;
  if (!near && std::abs(std::log(unit_scale_)) < 1.6) scales.push_back(unit_scale_);
  return scales;
}

std::vector<Search::Candidate> Search::coarse() const {
  std::vector<Candidate> candidates{{current(), 0, true, 0}};
  if (!options_.coarse) return candidates;
  const int count = 1024;
  const std::vector<Sample> fixed = sample_surface(fixed_, count);
  for (int mirrored = 0; mirrored <= int(options_.allow_mirror); ++mirrored) {
    const std::vector<Sample> moving(samples_[mirrored].begin(), samples_[mirrored].begin() + count);
    const Vec3 flip(mirrored ? -1 : 1, 1, 1);
    const Eigen::Matrix3d covariance = flip.asDiagonal() * moving_.covariance * flip.asDiagonal();
    for (double scale : start_scales()) {
      Candidate here{current(), 0, false, 0};
      here.pose.mirrored = mirrored, here.pose.scale = scale, here.pose.translation.setZero();
      candidates.push_back(here);  // only moved
      for (const CoarsePose& c : coarse_poses(moving, covariance, fixed, fixed_.covariance,
                                              moving_.area() / fixed_.area(), scale, options_.overlap, mirrored))
        candidates.push_back({c.pose, 0, c.thesis, 0});
    }
  }
  return candidates;
}

/// How well the fixed surface is covered, as far as the moving one's area goes:
/// of poses that lay the part equally well on something, the one that something
/// fits to as well is right. In the moving surface's unit, like IcpResult::score.
double Search::reverse_score(const Pose& pose, const ClosestPoint& moving, int samples) const {
  Pose inverse;
  inverse.rotation = pose.rotation.transpose();
  inverse.scale = 1 / pose.scale;
  inverse.translation = -inverse.scale * (inverse.rotation * pose.translation);
  if (pose.mirrored) {
    inverse.rotation.row(0) *= -1, inverse.rotation.col(0) *= -1;
    inverse.translation[0] *= -1;
  }
  const double share =
      std::min(1.0, options_.overlap * moving_.area() * pose.scale * pose.scale / fixed_.area());
  return PoseScore(fixed_samples_[pose.mirrored], samples, share, moving)(inverse) * inverse.scale;
}

void Search::score(std::vector<Candidate>& candidates, const ClosestPoint& moving, const ClosestPoint& fixed, int samples) {
  const int band = 256, n = int(candidates.size());
  run_tasks((n + band - 1) / band, threads_, progress_, [&](int b, const std::function<void()>&) {
    PoseScore of[2] = {{samples_[0], samples, options_.overlap, fixed}, {samples_[1], samples, options_.overlap, fixed}};
    for (int i = b * band; i < std::min(n, (b + 1) * band); ++i)
      candidates[i].score = std::hypot(of[candidates[i].pose.mirrored](candidates[i].pose), REV * reverse_score(candidates[i].pose, moving, samples));
  });
}

void Search::refine(std::vector<Candidate>& candidates, const ClosestPoint& moving, const ClosestPoint& fixed, const IcpOptions& icp_options) {
  run_tasks(int(candidates.size()), threads_, progress_, [&](int i, const std::function<void()>& poll) {
    Candidate& c = candidates[i];
    const IcpResult r = icp(samples_[c.pose.mirrored], fixed, c.pose, icp_options, poll);
    c.pose = r.pose, c.score = std::hypot(r.score, REV * reverse_score(r.pose, moving, icp_options.samples)), c.iterations = r.iterations;
    if (!options_.allow_scale && FREE > 0 && icp_options.samples >= FREEMIN && options_.coarse) {
      IcpOptions o = icp_options;
      o.scale = true, o.iterations = 10, o.samples = std::min(o.samples, 600);
      const IcpResult f = icp(samples_[c.pose.mirrored], fixed, c.pose, o, poll);
      c.score = std::pow(c.score, 1 - FREE) * std::pow(std::hypot(f.score, REV * reverse_score(f.pose, moving, o.samples)), FREE);
    }
  });
}

/// The best ones (and those to keep anyway), none closer to a better one than
/// spacing: radians, RMS radii.
void Search::keep_best(std::vector<Candidate>& candidates, int count, double spacing) const {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](const Candidate& a, const Candidate& b) { return rank(a) < rank(b); });
  std::vector<Candidate> kept;
  for (const Candidate& c : candidates) {
    if (int(kept.size()) >= count && !c.keep) continue;
    const auto same = [&](const Candidate& k) {
      return k.pose.mirrored == c.pose.mirrored && std::abs(std::log(k.pose.scale / c.pose.scale)) < spacing &&
             (k.pose.translation - c.pose.translation).norm() < spacing * c.pose.scale &&
             angle_between(k.pose.rotation, c.pose.rotation) < spacing;
    };
    const auto twin = std::find_if(kept.begin(), kept.end(), same);
    if (twin == kept.end())
      kept.push_back(c);
    else
      twin->keep |= c.keep;
  }
  candidates = std::move(kept);
}

/// How far a pose takes the model from where it is: radians and RMS radii.
double Search::motion(const Pose& p) const {
  const Pose here = current();
  return angle_between(p.rotation, here.rotation) + (p.translation - here.translation).norm() / here.scale +
         (p.mirrored ? 10 : 0);
}

const Search::Candidate& Search::choose(const std::vector<Candidate>& candidates) const {
  double best = INFINITY;
  for (const Candidate& c : candidates) best = std::min(best, rank(c));
  const Candidate* chosen = nullptr;
  for (const Candidate& c : candidates)
    if (rank(c) <= best * (1 + kTie) + 1e-6 && (!chosen || motion(c.pose) < motion(chosen->pose))) chosen = &c;
  return *chosen;
}

std::vector<double> Search::distances(const Pose& pose) const {
  std::vector<double> d(samples_[0].size());
  parallel_for(long(d.size()), threads_, [&](long begin, long end) {
    int hint = 0;
    for (long i = begin; i < end; ++i) {
      const Vec3 p = pose(samples_[pose.mirrored][i].point);
      d[i] = (tree_.closest(p, hint).point - p).norm() * fixed_.size;
    }
  });
  std::sort(d.begin(), d.end());
  return d;
}

double Search::trimmed_rms(std::vector<double> d) const {
  d.resize(std::clamp<std::size_t>(std::ceil(options_.overlap * d.size()), 1, d.size()));
  double sum = 0;
  for (double x : d) sum += x * x;
  return std::sqrt(sum / d.size());
}

Eigen::Matrix4d Search::world_matrix(const Pose& pose) const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  const double scale = options_.allow_scale ? pose.scale * fixed_.size / moving_.size : 1;
  Eigen::Matrix3d linear = scale * pose.rotation;
  if (pose.mirrored) linear.col(0) *= -1;
  m.topLeftCorner<3, 3>() = linear;
  m.topRightCorner<3, 1>() = fixed_.origin + fixed_.size * pose.translation - linear * moving_.origin;
  return m;
}

AlignResult Search::run() {
  AlignResult result;
  std::vector<Candidate> candidates = coarse();
  result.candidates = int(candidates.size());
  if (options_.coarse) {
    progress_.stage("Trying coarse poses", 5, 20);
    const ClosestSampleGrid grid(sample_surface(fixed_, kGridSamples), kGridCells);
    const ClosestSampleGrid moving_grid(sample_surface(moving_, kGridSamples), kGridCells);
    score(candidates, moving_grid, grid, kScoreSamples);
    keep_best(candidates, kScored, 0.1);
    int percent = 20;
    for (const Level& level : kLevels) {
      progress_.stage("Refining the best poses", percent, percent + 20);
      percent += 20;
      IcpOptions icp_options{level.samples, level.iterations, options_.overlap, options_.allow_scale && level.may_scale,
                     level.sliding, 1e-3};
      refine(candidates, level.exact ? static_cast<const ClosestPoint&>(moving_tree_) : moving_grid, level.exact ? static_cast<const ClosestPoint&>(tree_) : grid, icp_options);
      for (Candidate& c : candidates) c.keep = false;
      if (level.exact) {
        const Candidate chosen = choose(candidates);
        keep_best(candidates, level.kept, 0.05);
        candidates.push_back(chosen);
      } else {
        keep_best(candidates, level.kept, 0.1);
      }
    }
  }
  progress_.stage("Refining the best pose", 80, 98);
  refine(candidates, moving_tree_, tree_, {kFinalSamples, options_.max_iterations, options_.overlap, options_.allow_scale, 0.05, 1e-8});
  const Candidate& best = choose(candidates);

  result.matrix = world_matrix(best.pose);
  result.iterations = best.iterations;
  result.rms_before = trimmed_rms(distances(current()));
  const std::vector<double> after = distances(best.pose);
  result.rms_after = trimmed_rms(after);
  const double match = std::max(3 * result.rms_after, 1e-3 * moving_.size);
  result.inlier_share = double(std::upper_bound(after.begin(), after.end(), match) - after.begin()) / after.size();
  return result;
}

}  // namespace

AlignResult align_part_in_whole(const Mesh& moving, const std::vector<char>& moving_part, const Mesh& fixed,
                                const std::vector<char>& fixed_part, const AlignOptions& options, Progress& progress) {
  if (!(options.overlap > 0) || options.overlap > 1)
    throw UserError("The overlap must be larger than 0 and at most 1: set the share of the part that should match.");
  progress.stage("Measuring the parts", 0, 5);
  const Surface m = make_surface(moving, moving_part, "moving");
  progress.at(0.5);
  const Surface f = make_surface(fixed, fixed_part, "fixed");
  progress.at(1);
  AlignResult result = Search(m, f, options, progress).run();
  progress.stage("Done", 100, 100);
  return result;
}

}  // namespace parts
