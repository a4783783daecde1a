// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/align/align.h"

#include <algorithm>
#include <cmath>

#include "parts/align/coarse_poses.h"
#include "parts/align/comparison.h"
#include "parts/align/roughness.h"
#include "parts/base/error.h"
#include "parts/base/parallel.h"
#include "parts/base/tasks.h"

namespace parts::align {
namespace {

// A level of the search: each takes more samples and leaves fewer poses.
struct Level {
  Detail detail;
  int iterations;
  double sliding;
  bool may_scale;  ///< far from the answer a free scale only shrinks
  int left;        ///< poses for the next level
  double spacing;  ///< between them: radians, RMS radii
};
constexpr Detail kScoring{64, false, false};
constexpr int kScored = 320;
constexpr Level kLevels[] = {
    {{100, false, false}, 6, 0.3, false, 64, 0.1},
    {{250, false, true}, 12, 0.2, true, 10, 0.1},
    {{600, true, true}, 20, 0.1, true, 2, 0.05},
};
// Below this overlap the smallest residual is often not of the right place: more
// poses are kept, and that with which most of the part lies on the other wins.
constexpr double kLittleOverlap = 0.6;
constexpr int kMorePoses = 4;
constexpr Detail kFinal{Comparison::kSamples, true, true};

// Residuals that differ by less are equally good: the pose that moves the model least is taken.
constexpr double kTie = 0.02, kTieFloor = 1e-6;
// A mirror image must be clearly better than the model as it is: most things are nearly symmetric.
constexpr double kMirrorHandicap = 1.15;

struct Candidate {
  Pose pose;
  int safe_levels = 0;  ///< how long it stays whatever its score
  double score = 0;
  int iterations = 0;
  double rank() const { return score * (pose.mirrored ? kMirrorHandicap : 1); }
};

class Search {
 public:
  /// @param noise  how far from each other surfaces that match may lie, in the moving surface's unit
  Search(const spatial::Surface& moving, const spatial::Surface& fixed, double noise, const AlignOptions& options,
         Progress& progress)
      : options_(options),
        progress_(progress),
        noise_(noise),
        threads_(thread_count(options.threads)),
        moving_(moving),
        fixed_(fixed),
        compare_(moving, fixed, options.overlap) {}

  AlignResult run();

 private:
  Pose current() const;
  std::vector<double> start_scales() const;
  std::vector<Candidate> coarse_candidates() const;
  std::vector<Candidate> search(std::vector<Candidate> candidates);
  void score(std::vector<Candidate>& candidates);
  void refine(std::vector<Candidate>& candidates, const Detail& detail, const IcpOptions& icp_options);
  double motion(const Pose& p) const;
  bool little_overlap() const { return options_.overlap < kLittleOverlap; }
  const Candidate& lies_on_most(const std::vector<Candidate>& candidates) const;
  const Candidate& choose(const std::vector<Candidate>& candidates) const;
  AlignResult result(const Candidate& chosen) const;

  const AlignOptions& options_;
  Progress& progress_;
  double noise_;
  int threads_;
  const spatial::Surface &moving_, &fixed_;
  Comparison compare_;
};

/// Where the models are now.
Pose Search::current() const {
  Pose p;
  p.scale = moving_.size / fixed_.size;
  p.translation = (moving_.origin - fixed_.origin) / fixed_.size;
  return p;
}

std::vector<double> Search::start_scales() const {
  const double now = current().scale;
  if (!options_.allow_scale) return {now};
  // Both surfaces have RMS radius 1, so 1 lays whole on whole; where one is a
  // part, it is smaller.
  std::vector<double> scales{1.0, 0.7, 1.4};
  const auto apart = [&](double s) { return std::abs(std::log(s / now)) > 0.15; };
  if (std::all_of(scales.begin(), scales.end(), apart) && now > 0.2 && now < 5) scales.push_back(now);
  return scales;
}

std::vector<Candidate> Search::coarse_candidates() const {
  const int samples = 1024, all_levels = int(std::size(kLevels));
  const std::vector<spatial::Sample> fixed(compare_.fixed_samples().begin(),
                                           compare_.fixed_samples().begin() + samples);
  std::vector<Candidate> candidates{{current(), all_levels}};
  for (int mirrored = 0; mirrored <= int(options_.allow_mirror); ++mirrored) {
    const std::vector<spatial::Sample>& all = compare_.moving_samples(mirrored);
    const std::vector<spatial::Sample> moving(all.begin(), all.begin() + samples);
    const Vec3 flip(mirrored ? -1 : 1, 1, 1);
    const Eigen::Matrix3d covariance = flip.asDiagonal() * moving_.covariance * flip.asDiagonal();
    for (double scale : start_scales()) {
      Pose shifted;  // turned as it is
      shifted.scale = scale, shifted.mirrored = mirrored;
      candidates.push_back({shifted, mirrored || candidates.size() > 1 ? 0 : all_levels});
      for (const CoarsePose& c : coarse_poses({moving, covariance, moving_.area()},
                                              {fixed, fixed_.covariance, fixed_.area()}, scale, options_.overlap)) {
        candidates.push_back({c.pose, c.thesis ? 1 : 0});
        candidates.back().pose.mirrored = mirrored;
      }
    }
  }
  return candidates;
}

void Search::score(std::vector<Candidate>& candidates) {
  const int band = 128, n = int(candidates.size());
  run_tasks((n + band - 1) / band, threads_, progress_, [&](int b, const std::function<void()>&) {
    for (int i = b * band; i < std::min(n, (b + 1) * band); ++i)
      candidates[i].score = compare_.score(candidates[i].pose, kScoring);
  });
}

void Search::refine(std::vector<Candidate>& candidates, const Detail& detail, const IcpOptions& icp_options) {
  run_tasks(int(candidates.size()), threads_, progress_, [&](int i, const std::function<void()>& poll) {
    Candidate& c = candidates[i];
    const IcpResult r = compare_.refine(c.pose, detail, icp_options, poll);
    c.pose = r.pose, c.score = r.score, c.iterations = r.iterations;
  });
}

/// The best ones (and those that are safe), none close to a better one.
std::vector<Candidate> best_of(std::vector<Candidate> candidates, int count, double spacing) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.rank() < b.rank(); });
  std::vector<Candidate> best;
  for (const Candidate& c : candidates) {
    if (int(best.size()) >= count && c.safe_levels <= 0) continue;
    const auto twin = std::find_if(best.begin(), best.end(), [&](const Candidate& b) {
      return b.pose.mirrored == c.pose.mirrored && std::abs(std::log(b.pose.scale / c.pose.scale)) < spacing &&
             (b.pose.translation - c.pose.translation).norm() < spacing * c.pose.scale &&
             angle_between(b.pose.rotation, c.pose.rotation) < spacing;
    });
    if (twin == best.end())
      best.push_back(c);
    else
      twin->safe_levels = std::max(twin->safe_levels, c.safe_levels);
  }
  return best;
}

std::vector<Candidate> Search::search(std::vector<Candidate> candidates) {
  compare_.prepare_grids();
  progress_.stage("Trying coarse poses", 10, 20);
  score(candidates);
  candidates = best_of(std::move(candidates), kScored, 0.1);
  int percent = 20;
  for (const Level& level : kLevels) {
    progress_.stage("Refining the best poses", percent, percent + 20);
    percent += 20;
    refine(candidates, level.detail,
           {level.detail.samples, level.iterations, options_.overlap, options_.allow_scale && level.may_scale,
            level.sliding, 1e-3});
    for (Candidate& c : candidates) --c.safe_levels;
    candidates = best_of(std::move(candidates), little_overlap() ? kMorePoses * level.left : level.left, level.spacing);
  }
  return candidates;
}

/// How far a pose takes the model from where it is: radians and RMS radii.
double Search::motion(const Pose& p) const {
  const Pose here = current();
  return angle_between(p.rotation, here.rotation) + (p.translation - here.translation).norm() / here.scale +
         (p.mirrored ? 10 : 0);
}

/// The pose with which most of the part lies on the fixed one.
const Candidate& Search::lies_on_most(const std::vector<Candidate>& candidates) const {
  const Candidate* chosen = nullptr;
  double most = -1;
  for (const Candidate& c : candidates) {
    const double share = compare_.share_within(noise_ * c.pose.scale, c.pose, threads_);
    if (share > most || (share == most && c.rank() < chosen->rank())) most = share, chosen = &c;
  }
  return *chosen;
}

const Candidate& Search::choose(const std::vector<Candidate>& candidates) const {
  if (little_overlap()) return lies_on_most(candidates);
  const auto by_rank = [](const Candidate& a, const Candidate& b) { return a.rank() < b.rank(); };
  const Candidate* chosen = &*std::min_element(candidates.begin(), candidates.end(), by_rank);
  const double good_enough = chosen->rank() * (1 + kTie) + kTieFloor;
  for (const Candidate& c : candidates)
    if (c.rank() <= good_enough && motion(c.pose) < motion(chosen->pose)) chosen = &c;
  return *chosen;
}

AlignResult Search::result(const Candidate& chosen) const {
  const Pose& pose = chosen.pose;
  AlignResult r;
  r.iterations = chosen.iterations;
  const double scale = options_.allow_scale ? pose.scale * fixed_.size / moving_.size : 1;
  Eigen::Matrix3d linear = scale * pose.rotation;
  if (pose.mirrored) linear.col(0) *= -1;
  r.matrix.topLeftCorner<3, 3>() = linear;
  r.matrix.topRightCorner<3, 1>() = fixed_.origin + fixed_.size * pose.translation - linear * moving_.origin;

  const auto trimmed_rms = [&](const std::vector<double>& sorted) {
    const auto n =
        std::clamp<std::size_t>(std::size_t(std::ceil(options_.overlap * double(sorted.size()))), 1, sorted.size());
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += sorted[i] * sorted[i];
    return std::sqrt(sum / double(n));
  };
  const std::vector<double> before = compare_.distances(current(), threads_),
                            after = compare_.distances(pose, threads_);
  r.rms_before = trimmed_rms(before) * fixed_.size;
  r.rms_after = trimmed_rms(after) * fixed_.size;
  r.inlier_share = compare_.share_within(noise_ * pose.scale, pose, threads_);
  r.overlap = options_.overlap;
  return r;
}

AlignResult Search::run() {
  std::vector<Candidate> candidates{{current()}};
  if (options_.coarse) candidates = coarse_candidates();
  const int tried = int(candidates.size());
  if (options_.coarse) candidates = search(std::move(candidates));
  progress_.stage("Refining the best pose", 80, 98);
  refine(candidates, kFinal,
         {kFinal.samples, options_.max_iterations, options_.overlap, options_.allow_scale, 0.05, 1e-8});
  AlignResult r = result(choose(candidates));
  r.candidates = tried;
  return r;
}

/// How much of the part should lie on the fixed one at least. Less than two
/// fifths say little: so much of one smooth thing lies on another in many ways.
double enough(double overlap) { return std::max(0.8 * overlap, 0.4); }
bool matches(const AlignResult& r) { return r.inlier_share >= enough(r.overlap); }

/// Looks anew with ever less overlap, and takes the first place at which all of
/// it matches, if that is clearly more than matches now.
AlignResult with_less_overlap(AlignResult found, const spatial::Surface& m, const spatial::Surface& f, double noise,
                              AlignOptions options, Progress& progress) {
  constexpr double kOverlaps[] = {0.7, 0.5, 0.3}, kMore = 0.1;
  int percent = 40;
  for (const double overlap : kOverlaps) {
    if (overlap >= found.overlap) continue;
    options.overlap = overlap;
    Progress part = progress.part(percent, percent + 19);
    percent += 19;
    AlignResult r = Search(m, f, noise, options, part).run();
    if (matches(r) && r.inlier_share > found.inlier_share + kMore) return r;
  }
  return found;
}

std::string percents(double share) { return std::to_string(int(std::lround(100 * share))) + " %"; }

/// A factor in words: "about 1000".
std::string about(double factor) {
  const double step = std::pow(10, std::floor(std::log10(factor)) - 1);
  return "about " + std::to_string(std::llround(std::round(factor / step) * step));
}

std::vector<std::string> doubts_of(const AlignResult& r, double size_ratio, const AlignOptions& options) {
  constexpr double kOtherUnit = 20;
  std::vector<std::string> doubts;
  const double factor = std::max(size_ratio, 1 / size_ratio);
  if (!options.allow_scale && factor > kOtherUnit)
    doubts.push_back("The moving part is " + about(factor) + " times as " + (size_ratio > 1 ? "large" : "small") +
                     " as the fixed one; if their units differ, switch AllowScale on or scale one of them first.");
  if (!matches(r))
    doubts.push_back("Only " + percents(r.inlier_share) + " of the moving part lie on the fixed one where " +
                     percents(std::max(r.overlap, enough(r.overlap))) +
                     " should; look at the place, and select the parts that match, give their Overlap, or place the "
                     "layer roughly by hand first.");
  else if (r.overlap < options.overlap)
    doubts.push_back("Only about " + percents(r.overlap) +
                     " of the moving part seem to have a counterpart, and it was placed by those; look at the place.");
  return doubts;
}

}  // namespace

AlignResult align_part_in_whole(const Mesh& moving, const std::vector<char>& moving_part, const Mesh& fixed,
                                const std::vector<char>& fixed_part, const AlignOptions& options, Progress& progress) {
  if (!(options.overlap > 0 && options.overlap <= 1))
    throw UserError("The overlap must be above 0 and at most 1: set the share of the part that should match.");
  const bool may_look_anew = options.less_overlap && options.coarse;
  const int first_share = may_look_anew ? 40 : 100;  // percent
  progress.stage("Measuring the parts", 0, first_share / 10);
  const spatial::Surface m = spatial::make_surface(moving, moving_part, "moving");
  progress.at(0.3);
  const spatial::Surface f = spatial::make_surface(fixed, fixed_part, "fixed");
  progress.at(0.6);
  constexpr double kNoise = 0.01, kMostNoise = 0.03;  // RMS radii of the moving part
  const double fixed_size = options.allow_scale ? f.size : m.size;
  const double rough = std::max(roughness(moving, moving_part) / m.size, roughness(fixed, fixed_part) / fixed_size);
  const double noise = std::clamp(3 * rough, kNoise, kMostNoise);
  progress.at(1);
  Progress first = progress.part(0, first_share);
  AlignResult result = Search(m, f, noise, options, first).run();
  if (may_look_anew && !matches(result)) result = with_less_overlap(result, m, f, noise, options, progress);
  result.doubts = doubts_of(result, m.size / f.size, options);
  progress.stage("Aligned", 100, 100);
  return result;
}

}  // namespace parts::align
