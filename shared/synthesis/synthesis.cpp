// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/synthesis/synthesis.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "parts/base/error.h"
#include "parts/synthesis/level.h"
#include "parts/synthesis/pyramid.h"

namespace parts::synthesis {
namespace {

constexpr long tree_windows = 60000;

void check_image(const PatchImage& image, const std::string& what, const std::vector<int>& may_be_empty) {
  if (image.mask.empty() || cv::countNonZero(image.mask) == 0)
    throw UserError("The mask of " + what + " is empty; give one with a foreground.");
  for (size_t p = 0; p < image.planes.size(); ++p) {
    if (image.planes[p].empty() && std::count(may_be_empty.begin(), may_be_empty.end(), int(p))) continue;
    if (image.planes[p].size() != image.mask.size())
      throw UserError("The images of " + what + " differ in size; give an image, a depth and a mask of one size.");
  }
}

void check_channels(const SynthesisOptions& options, int planes) {
  if (options.channels.empty() || options.channels.size() > size_t(most_channels))
    throw std::invalid_argument("synthesize: " + std::to_string(options.channels.size()) + " channels; give 1 to " +
                                std::to_string(most_channels));
  std::vector<int> used = options.synthesized;
  for (const PatchChannel& channel : options.channels) used.push_back(channel.plane);
  for (int plane : used)
    if (plane < 0 || plane >= planes)
      throw std::invalid_argument("synthesize: plane " + std::to_string(plane) + " of examples that have " +
                                  std::to_string(planes));
}

// Windows' sides a level, coarse to fine; more levels for larger images.
std::vector<int> level_sides(const PatchImage& query, const SynthesisOptions& options) {
  std::vector<int> sides = options.patch_sizes;
  if (sides.empty()) throw UserError("No patch size is given; give one for each level, as in 5,7,9.");
  for (int s : sides)
    if (s < 3 || s % 2 == 0 || s > 31)
      throw UserError("The patch size " + std::to_string(s) + " cannot be used; give odd numbers from 3 to 31.");
  const int longest = std::max(query.mask.cols, query.mask.rows), shortest = std::min(query.mask.cols, query.mask.rows);
  while (options.longest_coarsest > 0 && (longest >> (sides.size() - 1)) > options.longest_coarsest)
    sides.insert(sides.begin(), sides.front());
  for (size_t i = 0; i < sides.size(); ++i)
    if (sides[i] > std::max(1, shortest >> (sides.size() - 1 - i)))
      throw UserError(
          "A patch of " + std::to_string(sides[i]) +
          " pixels is larger than the image at its level; give smaller patches, fewer levels or a larger image.");
  return sides;
}

class Optimizer {
 public:
  Optimizer(const PatchImage& query, const std::vector<PatchImage>& examples, const SynthesisOptions& options,
            const ExampleUpdate& update, const Agreement& agree)
      : options_(options), update_(update), agree_(agree), sides_(level_sides(query, options)) {
    levels_ = int(sides_.size());
    PatchImage padded = query;
    padded.planes.resize(std::max(query.planes.size(), examples.front().planes.size()));
    query_ = make_pyramid(padded, levels_);
    for (const PatchImage& e : examples) add(e);
    size_ = options.size > 0 ? options.size : std::sqrt(double(cv::countNonZero(query.mask)));
  }

  SynthesisResult run(Progress& progress) {
    for (level_ = levels_ - 1; level_ >= 0; --level_) {
      // A level costs four times the one before.
      const int from = level_ == levels_ - 1 ? 0 : int(100 * std::pow(0.25, level_ + 1));
      progress.stage("Synthesising", from, int(100 * std::pow(0.25, level_)));
      run_level(progress);
    }
    return result();
  }

 private:
  void add(const PatchImage& example) {
    pyramids_.push_back(make_pyramid(example, levels_));
    active_.push_back(1);
  }

  LevelExample level_example(int k) const {
    LevelExample e = make_level_example(pyramids_[k], options_, setup_);
    e.active = active_[k];
    return e;
  }

  void activate(bool synthesized) {
    for (size_t c = 0; c < options_.channels.size(); ++c)
      if (std::count(options_.synthesized.begin(), options_.synthesized.end(), options_.channels[c].plane))
        setup_.layout.active[c / 4][c % 4] = synthesized;
  }

  void build_tree() {
    tree_.reset();
    if (!options_.exact_search)
      tree_ = std::make_unique<PatchTree>(examples_, setup_.layout, tree_windows, options_.pca_share, options_.threads);
  }

  void run_level(Progress& progress) {
    setup_ = make_setup(pyramids_, options_, level_, sides_[levels_ - 1 - level_], size_);
    examples_.clear();
    for (size_t k = 0; k < pyramids_.size(); ++k) examples_.push_back(level_example(int(k)));
    if (setup_.searched) objective_.emplace_back();
    if (level_ == levels_ - 1)
      begin_coarsest();
    else
      begin_finer();
    if (!setup_.searched) return;
    activate(true);
    build_tree();
    double last = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < options_.max_iterations; ++i) {
      progress.at(double(i) / options_.max_iterations);
      plane_ = make_level_query(query_, estimate_, options_, setup_);
      search(plane_, query_.coverage[level_], examples_, setup_.layout, tree_.get(), options_.threads, matches_);
      const double now = objective();
      objective_.back().push_back(now);
      maximize();
      if (now - last < options_.tolerance * std::abs(now)) break;
      last = now;
      if (i == 0 && update_) change_examples();
    }
  }

  void begin_coarsest() {
    plane_ = make_level_query(query_, {}, options_, setup_);
    matches_.assign(long(plane_.width) * plane_.height, {});
    activate(false);
    build_tree();
    search(plane_, query_.coverage[level_], examples_, setup_.layout, tree_.get(), options_.threads, matches_);
    const std::vector<Votes> votes = vote_all();
    estimate_.clear();
    for (const Votes& v : votes) {
      cv::Mat value;
      cv::divide(v.value, v.weight, value);
      estimate_.push_back(extend(value, v.weight > 0));
    }
    coarse_.clear();
    agree();
  }

  // The coarser level's matches, at twice their coordinates (4.1.1).
  void begin_finer() {
    const PatchPlane coarse = plane_;
    const std::vector<Match> before = matches_;
    coarse_ = estimate_;
    plane_ = make_level_query(query_, {}, options_, setup_);
    matches_.assign(long(plane_.width) * plane_.height, {});
    for (int y = 0; y < plane_.height; ++y)
      for (int x = 0; x < plane_.width; ++x) {
        if (!plane_.inside[plane_.index(x, y)]) continue;
        const Match* best = nullptr;
        int bx = 0, by = 0, nearest = 1 << 30;
        for (int r = 0; !best && r < 4; ++r)
          for (int v = y / 2 - r; v <= y / 2 + r; ++v)
            for (int u = x / 2 - r; u <= x / 2 + r; ++u) {
              if (u < 0 || v < 0 || u >= coarse.width || v >= coarse.height) continue;
              const Match& m = before[coarse.index(u, v)];
              const int far = (2 * u - x) * (2 * u - x) + (2 * v - y) * (2 * v - y);
              if (m.example >= 0 && far < nearest) best = &m, bx = u, by = v, nearest = far;
            }
        if (!best) continue;
        const PatchPlane& e = examples_[best->example].plane;
        matches_[plane_.index(x, y)] = {best->example, std::clamp(2 * best->x + x - 2 * bx, 0, e.width - 1),
                                        std::clamp(2 * best->y + y - 2 * by, 0, e.height - 1), best->distance};
      }
    const std::vector<Votes> votes = vote_all();
    for (size_t s = 0; s < estimate_.size(); ++s) estimate_[s] = proposal(votes[s], int(s));
    agree();
  }

  void agree() {
    if (agree_) agree_(level_, estimate_);
  }

  std::vector<Votes> vote_all() const {
    return vote(plane_, matches_, examples_, setup_.layout, int(options_.synthesized.size()), options_.threads);
  }

  // The coarser estimate and the voted detail (thesis 4.3.1). What this level's
  // windows say of the coarse part counts as much as the coarser level: windows
  // that were matched again with more detail know better where they lie. On still
  // finer levels their steps from example to example would show as lumps.
  cv::Mat proposal(const Votes& votes, int s) const {
    cv::Mat mean;
    if (coarse_.empty()) {
      cv::divide(votes.value, votes.weight, mean);
      return extend(mean, votes.weight > 0);
    }
    cv::Mat value, half;
    cv::divide(votes.value, votes.weight, value);
    cv::pyrDown(extend(value, votes.weight > 0), half);
    cv::divide(votes.band, votes.weight, mean);
    mean.setTo(0, votes.weight <= 0);
    const bool corrects = levels_ - 1 - level_ <= 2;
    return expand(corrects ? cv::Mat(0.5 * (coarse_[s] + half)) : coarse_[s], mean.size()) + mean;
  }

  // The M step: towards the voted planes, as far as the objective gains. For
  // fixed matches it is a quadratic in each pixel.
  void maximize() {
    const std::vector<Votes> votes = vote_all();
    const std::vector<cv::Mat> before = estimate_;
    for (size_t s = 0; s < estimate_.size(); ++s) estimate_[s] = proposal(votes[s], int(s));
    agree();
    for (size_t s = 0; s < estimate_.size(); ++s) {
      const cv::Mat step = estimate_[s] - before[s];
      double gain = 0, curve = 0;
      const cv::Mat& coverage = query_.coverage[level_];
      for (int y = 0; y < step.rows; ++y)
        for (int x = 0; x < step.cols; ++x) {
          const double a = double(votes[s].weight.at<float>(y, x)) * coverage.at<float>(y, x);
          const double b = double(votes[s].value.at<float>(y, x)) * coverage.at<float>(y, x);
          const double d = step.at<float>(y, x);
          gain += (b - a * before[s].at<float>(y, x)) * d;
          curve += a * d * d;
        }
      const double t = curve > 0 ? std::clamp(gain / curve, 0.0, 1.0) : 0.0;
      estimate_[s] = before[s] + step * t;
    }
  }

  double objective() const {
    double sum = 0;
    long count = 0;
    for (const Match& m : matches_)
      if (m.example >= 0) sum += m.distance, ++count;
    return count ? -sum / (2.0 * double(count)) : 0;
  }

  std::vector<long> used() const {
    std::vector<long> count(pyramids_.size(), 0);
    for (const Match& m : matches_)
      if (m.example >= 0) ++count[m.example];
    return count;
  }

  void change_examples() {
    std::vector<cv::Mat> planes;
    for (size_t p = 0; p < query_.planes.size(); ++p) planes.push_back(query_.planes[p][level_]);
    for (size_t s = 0; s < estimate_.size(); ++s) planes[options_.synthesized[s]] = estimate_[s];
    const cv::Mat mask = query_.coverage[level_] >= 0.5f;
    const std::vector<long> count = used();
    const ExampleChange change = update_({level_, levels_, planes, mask, count, active_});
    if (change.drop.empty() && change.add.empty()) return;
    for (int k : change.drop) active_[k] = examples_[k].active = 0;
    for (const PatchImage& e : change.add) {
      add(e);
      examples_.push_back(level_example(int(pyramids_.size()) - 1));
    }
    build_tree();
  }

  SynthesisResult result() {
    SynthesisResult r;
    const cv::Size size(plane_.width, plane_.height);
    const cv::Mat inside = query_.coverage[0] >= 0.5f;
    for (const cv::Mat& e : estimate_) {
      cv::Mat plane = cv::Mat::zeros(size, CV_32F);
      e.copyTo(plane, inside);
      r.planes.push_back(plane);
    }
    r.example = cv::Mat(size, CV_32S, cv::Scalar(-1));
    r.source = cv::Mat(size, CV_32SC2, cv::Scalar(0, 0));
    r.distance = cv::Mat::zeros(size, CV_32F);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const Match& m = matches_[plane_.index(x, y)];
        if (m.example < 0) continue;
        r.example.at<int>(y, x) = m.example;
        r.source.at<cv::Vec2i>(y, x) = {m.x, m.y};
        r.distance.at<float>(y, x) = std::sqrt(std::max(0.f, m.distance));
      }
    r.objective = objective_;
    r.used = used();
    r.active = active_;
    return r;
  }

  const SynthesisOptions& options_;
  const ExampleUpdate& update_;
  const Agreement& agree_;
  std::vector<int> sides_;
  int levels_ = 1, level_ = 0;
  double size_ = 1;
  ImagePyramid query_;
  std::vector<ImagePyramid> pyramids_;
  std::vector<char> active_;

  LevelSetup setup_;
  std::vector<LevelExample> examples_;
  std::unique_ptr<PatchTree> tree_;
  PatchPlane plane_;
  std::vector<Match> matches_;
  std::vector<cv::Mat> estimate_, coarse_;
  std::vector<std::vector<double>> objective_;
};

}  // namespace

SynthesisResult synthesize(const PatchImage& query, const std::vector<PatchImage>& examples,
                           const SynthesisOptions& options, const ExampleUpdate& update, Progress& progress,
                           const Agreement& agree) {
  if (examples.empty()) throw UserError("There is no example; give a database with at least one.");
  size_t planes = examples.front().planes.size();
  for (const PatchImage& e : examples) planes = std::min(planes, e.planes.size());
  check_channels(options, int(planes));
  check_image(query, "the query", options.synthesized);
  for (size_t k = 0; k < examples.size(); ++k) check_image(examples[k], "example " + std::to_string(k), {});
  return Optimizer(query, examples, options, update, agree).run(progress);
}

}  // namespace parts::synthesis
