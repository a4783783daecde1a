// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/search/search.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "parts/align/coarse_poses.h"
#include "parts/align/icp.h"
#include "parts/base/error.h"
#include "parts/base/parallel.h"
#include "parts/base/tasks.h"
#include "parts/search/correlation.h"
#include "parts/search/model_cache.h"
#include "parts/search/query_surface.h"

namespace parts::search {
namespace {

constexpr double kScaleStep = 1.2;  // from one scale of the coarsest search to the next
constexpr int kNear = 11;           // rotations tried near the model's own
constexpr int kRotations = 84;      // tried for models that may lie any way
constexpr double kFarthest = 0.35;  // radii of the region: distances count up to it
constexpr double kTurned = 0.1;     // what a normal across the other surface's costs, in kFarthest squared
constexpr int kPlaces = 10;         // of a model that the coarsest search proposes
constexpr int kPoints = 4000;       // of the query, in the coarsest search

/// A scale of the search. `reach`: how far around the region the surface counts,
/// in its radii (QuerySurface::weight).
struct Scale {
  double reach;
  int samples, iterations;
  int places;  ///< of a model that go on to the next scale
};
/// How a search goes about it, from coarse to fine; the last scale is the exact fit.
struct Plan {
  Correlation::Size size;
  std::array<Scale, 4> scales;
};
constexpr Plan kUsual{Correlation::kCoarse, {{{4, 160, 15, 4}, {3, 300, 15, 2}, {2, 600, 20, 1}, {1.5, 1000, 30, 1}}}};
/// Where the usual one finds nothing that fits well: the region with less around
/// it, as models with joints may agree there only; the best kLookedAtAgain models.
constexpr Plan kCloser{Correlation::kFine,
                       {{{1.5, 160, 15, 4}, {1.5, 300, 15, 2}, {1.5, 600, 20, 1}, {1.5, 1000, 30, 1}}}};
constexpr int kLookedAtAgain = 32;
constexpr int kFit = int(kUsual.scales.size()) - 1, kLevels = kFit;

/// Where a model may be: the query's frame in the model's.
struct Place {
  align::Pose pose;
  double score = 0;
};

struct Entry {
  int model = -1;
  const ModelRaster* raster = nullptr;
  Correlation::Model spectrum;
  double unit = 1;            ///< the query's frame in the model's, where world units are the same
  std::vector<int> scales;    ///< to try, as powers of kScaleStep: voxels of the coarsest grid
  std::vector<Place> places;  ///< best first
  double score() const { return places.empty() ? INFINITY : places[0].score; }
};

void keep_best(std::vector<Place>& places, std::size_t most) {
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.score < b.score; });
  if (places.size() > most) places.resize(most);
}

align::Pose inverse(const align::Pose& p) {
  align::Pose q;
  q.rotation = p.rotation.transpose();
  q.scale = 1 / p.scale;
  q.translation = -q.scale * (q.rotation * p.translation);
  return q;
}

class Searcher {
 public:
  Searcher(const SearchQuery& query, const io::ModelDatabase& database, const SearchOptions& options,
           Progress& progress, SearchMemory& memory)
      : query_(query),
        memory_(memory),
        database_(database),
        options_(options),
        progress_(progress),
        threads_(thread_count(options.threads)),
        levels_(std::clamp(options.levels, 1, kLevels)) {}

  std::vector<Candidate> run() {
    progress_.stage("Reading the models", 0, 40);
    if (!memory_.models) {
      auto models =
          std::make_shared<ModelCache>(database_, ModelCache::Options{levels_, options_.cache, options_.threads});
      models->fill(progress_);
      memory_.models = std::move(models);  // only when it is whole
    }
    progress_.stage("Preparing the scan", 40, 42);
    surface_ = std::make_unique<QuerySurface>(query_);
    std::vector<int> models;
    for (int m = 0; m < database_.size(); ++m)
      if (memory_.models->raster(m)) models.push_back(m);
    if (models.empty()) throw UserError("No model of the database can be used; the log says why each was skipped.");

    std::vector<Candidate> found;
    if (!memory_.placements.empty()) found = search(kUsual, models, true, 42, 55);
    if (found.empty() || found[0].score > kDoubtful) merge(found, search(kUsual, models, false, 55, 75));
    if (found[0].score > kDoubtful && window_is_smaller()) {
      models.assign(promising_.begin(), promising_.begin() + std::min(promising_.size(), std::size_t(kLookedAtAgain)));
      merge(found, search(kCloser, models, false, 75, 100));
    }
    found.resize(std::min(found.size(), std::size_t(std::max(options_.candidates, 1))));
    progress_.stage("Found", 100, 100);
    return found;
  }

 private:
  std::vector<Candidate> search(const Plan& plan, const std::vector<int>& models, bool remembered, int from, int to);
  Eigen::Affine3d placement_of(const align::Pose& pose, const ModelRaster& raster) const;
  align::Pose pose_of(const Eigen::Affine3d& placement, const ModelRaster& raster) const;
  bool window_is_smaller() const;
  static void merge(std::vector<Candidate>& found, const std::vector<Candidate>& more);
  void choose_scales(Entry& e) const;
  std::vector<Eigen::Matrix3d> rotations() const;
  void search_everywhere(int from, int to);
  void propose(Entry& e, int scale, const Eigen::Matrix3d& rotation, const Correlation::Best& best) const;
  align::IcpOptions icp_options(const Scale& scale, double overlap, double done) const;
  void refine(int level);
  void drop_worse_half();
  std::vector<Candidate> fit();
  double score(const align::Pose& pose, const ModelRaster& raster, const spatial::ClosestPoint& model, bool exact,
               int scale) const;

  const SearchQuery& query_;
  SearchMemory& memory_;
  const io::ModelDatabase& database_;
  const SearchOptions& options_;
  Progress& progress_;
  int threads_, levels_;
  std::unique_ptr<QuerySurface> surface_;
  const Plan* plan_ = nullptr;
  std::vector<spatial::Sample> samples_[kFit + 1];  ///< of each scale
  double area_[kFit + 1] = {};
  std::vector<Entry> entries_;
  std::vector<int> promising_;  ///< models in the order of the coarsest scale
};

std::vector<Candidate> Searcher::search(const Plan& plan, const std::vector<int>& models, bool remembered, int from,
                                        int to) {
  plan_ = &plan;
  for (int l = 0; l <= kFit; ++l) {
    samples_[l] = surface_->samples(plan.scales[l].reach, l == 0 ? kPoints : plan.scales[l].samples);
    area_[l] = surface_->weighted_area(plan.scales[l].reach);
  }
  entries_.clear();
  if (&plan == &kUsual) promising_.clear();
  for (int m : models) {
    Entry e;
    e.model = m;
    e.raster = memory_.models->raster(m);
    const auto known = memory_.placements.find(m);
    if (remembered && known == memory_.placements.end()) continue;
    if (remembered) {
      e.places.push_back({pose_of(known->second, *e.raster)});
    } else {
      e.spectrum = Correlation::model(*e.raster, plan.size);
      choose_scales(e);
    }
    entries_.push_back(std::move(e));
  }
  const auto percent = [&](int share) { return from + (to - from) * share / 100; };
  if (!remembered) search_everywhere(percent(0), percent(50));
  progress_.stage("Comparing the best places", percent(50), percent(60));
  refine(0);
  if (&plan == &kUsual)
    for (const Entry& e : entries_) memory_.placements[e.model] = placement_of(e.places[0].pose, *e.raster);
  drop_worse_half();
  for (int l = 1; l < levels_; ++l) {
    progress_.stage("Comparing more finely", percent(50 + 10 * l), percent(60 + 10 * l));
    refine(l);
    drop_worse_half();
  }
  progress_.stage("Fitting the best models", percent(80), percent(100));
  return fit();
}

Eigen::Affine3d Searcher::placement_of(const align::Pose& pose, const ModelRaster& raster) const {
  const align::Pose back = inverse(pose);
  Eigen::Affine3d placement = Eigen::Affine3d::Identity();
  placement.linear() = back.scale * surface_->size() / raster.size * back.rotation;
  placement.translation() =
      surface_->origin() + surface_->size() * back.translation - placement.linear() * raster.origin;
  return placement;
}

align::Pose Searcher::pose_of(const Eigen::Affine3d& placement, const ModelRaster& raster) const {
  const double scale = placement.linear().col(0).norm();
  align::Pose p;
  p.rotation = (placement.linear() / scale).transpose();
  p.scale = surface_->size() / (raster.size * scale);
  p.translation = (p.rotation * (surface_->origin() - placement.translation()) / scale - raster.origin) / raster.size;
  return p;
}

/// Whether the closer search sees less around the region than the usual one, but all of the region.
bool Searcher::window_is_smaller() const {
  const Entry& e = entries_[0];
  const double window = Correlation::kWindow / Correlation::kFine.model_side *
                        double(e.raster->box().sizes().maxCoeff()) / e.places[0].pose.scale;
  return surface_->radius() < window;
}

/// Of a model found twice the better place.
void Searcher::merge(std::vector<Candidate>& found, const std::vector<Candidate>& more) {
  for (const Candidate& c : more) {
    const auto same = std::find_if(found.begin(), found.end(), [&](const Candidate& f) { return f.model == c.model; });
    if (same == found.end())
      found.push_back(c);
    else if (c.score < same->score)
      *same = c;
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
}

/// World units are taken to be the same, give or take a little, and sizes to be
/// the same; where they are not, both are tried.
void Searcher::choose_scales(Entry& e) const {
  e.unit = surface_->size() / e.raster->size;
  if (!options_.allow_scale && std::abs(std::log(e.unit)) > std::log(4)) {
    double best = INFINITY;
    const double unit = e.unit;
    for (double factor : {1.0, 10.0, 12.0, 25.4, 100.0, 39.3701, 304.8, 1000.0, 30.48, 3.28084, 2.54, 0.9144, 914.4})
      for (double f : {factor, 1 / factor})
        if (std::abs(std::log(unit * f)) < best) best = std::abs(std::log(unit * f)), e.unit = unit * f;
  }
  const auto step = [&](double scale) {
    return int(std::lround(std::log(scale / e.spectrum.cell) / std::log(kScaleStep)));
  };
  const int same_unit = step(e.unit), same_size = step(1);
  e.scales = {same_unit};
  if (!options_.allow_scale) return;
  for (int i : {same_unit - 1, same_unit + 1, same_size - 1, same_size, same_size + 1})
    if (std::find(e.scales.begin(), e.scales.end(), i) == e.scales.end()) e.scales.push_back(i);
}

std::vector<Eigen::Matrix3d> Searcher::rotations() const {
  std::vector<Eigen::Matrix3d> r;
  for (int i = 0; i < kNear; ++i) {  // 25 degrees about axes spread over the sphere
    const double z = 1 - (2 * i + 1) / double(kNear), a = 2.399963229728653 * i;
    const Vec3 axis(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z);
    r.push_back(Eigen::AngleAxisd(25 * M_PI / 180, axis).toRotationMatrix());
  }
  if (options_.any_rotation)
    for (const Eigen::Matrix3d& turn : align::spread_rotations(kRotations)) r.push_back(turn);
  r.insert(r.begin(), Eigen::Matrix3d::Identity());
  return r;
}

void Searcher::propose(Entry& e, int scale, const Eigen::Matrix3d& rotation, const Correlation::Best& best) const {
  Place p;
  p.pose.scale = options_.allow_scale ? std::pow(kScaleStep, scale) * e.spectrum.cell : e.unit;
  p.pose.rotation = rotation;
  p.pose.translation = e.spectrum.center + e.spectrum.cell * best.shift.cast<double>() -
                       p.pose.scale * (rotation * surface_->region().center());
  p.score = -best.similarity;
  e.places.push_back(p);
}

void Searcher::search_everywhere(int from, int to) {
  const std::vector<Eigen::Matrix3d> turns = rotations();
  std::vector<Correlation::Point> points;
  for (const spatial::Sample& s : samples_[0])
    points.push_back({s.point - surface_->region().center(), 1 / surface_->weight(s.point, plan_->scales[0].reach)});
  std::map<int, std::vector<Entry*>> by_scale;
  for (Entry& e : entries_)
    for (int s : e.scales) by_scale[s].push_back(&e);
  int halves = 0;  // of the scales' work: the query's spectra, then the models'
  const auto next_half = [&] {
    const int all = 2 * int(by_scale.size()), first = halves++;
    progress_.stage("Comparing everywhere", from + (to - from) * first / all, from + (to - from) * halves / all);
  };
  for (const auto& [scale, entries] : by_scale) {
    next_half();
    const double to_voxels = std::pow(kScaleStep, scale);
    std::vector<Correlation::Query> queries(turns.size() / 2);
    run_tasks(int(queries.size()), threads_, progress_, [&](int i, const auto&) {
      queries[i] = Correlation::query(points, plan_->size, to_voxels * turns[2 * i], to_voxels * turns[2 * i + 1]);
    });
    next_half();
    run_tasks(int(entries.size()), threads_, progress_,
              [&, scale = scale, &entries = entries](int i, const auto& poll) {
                for (std::size_t q = 0; q < queries.size(); ++q) {
                  if (q % 16 == 0) poll();
                  const auto best = Correlation::best(queries[q], entries[i]->spectrum);
                  for (int k = 0; k < 2; ++k) propose(*entries[i], scale, turns[2 * q + k], best[k]);
                }
                keep_best(entries[i]->places, kPlaces);
              });
  }
}

void Searcher::drop_worse_half() {
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.score() < b.score(); });
  if (promising_.empty())
    for (const Entry& e : entries_) promising_.push_back(e.model);
  const std::size_t least = std::size_t(std::max(options_.candidates, 1) + 2);
  entries_.resize(std::min(entries_.size(), std::max((entries_.size() + 1) / 2, least)));
}

/// The squared distance from a surface of which the nearest sample is known:
/// across it, and along it where that is more than the samples' spacing.
double squared_distance(const Vec3& p, const Vec3& sample, const Vec3& normal, double spacing) {
  const Vec3 d = p - sample;
  const double across = d.dot(normal), along2 = std::max(0.0, d.squaredNorm() - across * across);
  const double along = std::max(0.0, std::sqrt(along2) - spacing);
  return across * across + along * along;
}

double Searcher::score(const align::Pose& pose, const ModelRaster& raster, const spatial::ClosestPoint& model,
                       bool exact, int scale_index) const {
  const Scale& scale = plan_->scales[scale_index];
  const std::vector<spatial::Sample>& samples = samples_[scale_index];
  const double weighted_area = area_[scale_index];
  const double most = kFarthest * surface_->radius(), most2 = most * most;
  const double spacing = exact ? 0 : std::sqrt(raster.area / double(raster.samples.size()));
  int hint = 0;
  double forth = 0;
  const int n = std::min(scale.samples, int(samples.size()));
  for (int i = 0; i < n; ++i) {
    const Vec3 p = pose(samples[i].point);
    const spatial::Closest c = model.closest(p, hint);
    const double d2 = squared_distance(p, c.point, c.normal, spacing) / (pose.scale * pose.scale);
    const double turned = 1 - std::abs(c.normal.dot(pose.rotation * samples[i].normal));
    forth += std::min(d2, most2) + kTurned * most2 * turned;
  }
  forth *= weighted_area / n;
  double back = 0, back_area = 0;
  const align::Pose to_query = inverse(pose);
  const int m = std::min(4 * scale.samples, int(raster.samples.size()));
  const double share = raster.area * to_query.scale * to_query.scale / m;
  for (int i = 0; i < m; ++i) {
    const Vec3 p = to_query(raster.samples[i].at.cast<double>());
    const double w = surface_->weight(p, scale.reach) * share;
    RasterPoint q;
    const QuerySurface::Known known = surface_->nearest(p, q);
    if (known == QuerySurface::Known::Nothing) continue;
    back_area += w;
    if (known == QuerySurface::Known::Far)
      back += w * most2;
    else
      back +=
          w * std::min(most2, squared_distance(p, q.at.cast<double>(), q.normal.cast<double>(), surface_->spacing()));
  }
  return std::sqrt((forth + back) / (weighted_area + back_area)) / surface_->radius();
}

align::IcpOptions Searcher::icp_options(const Scale& scale, double overlap, double done) const {
  align::IcpOptions o;
  o.samples = scale.samples;
  o.iterations = scale.iterations;
  o.overlap = overlap;
  o.scale = options_.allow_scale;
  o.done = done;
  return o;
}

void Searcher::refine(int level) {
  const Scale& scale = plan_->scales[level];
  const int grid = std::min(std::max(level, 1), levels_ - 1);
  run_tasks(int(entries_.size()), threads_, progress_, [&](int i, const std::function<void()>& poll) {
    Entry& e = entries_[i];
    if (grid > 1) memory_.models->complete(e.model);
    const RasterTarget target(*e.raster, grid);
    for (Place& p : e.places) {
      p.pose = align::icp(samples_[level], target, p.pose, icp_options(scale, 0.8, 1e-3), poll).pose;
      p.score = score(p.pose, *e.raster, target, false, level);
    }
    keep_best(e.places, std::size_t(scale.places));
  });
}

std::vector<Candidate> Searcher::fit() {
  const Scale& scale = plan_->scales[kFit];
  entries_.resize(std::min(entries_.size(), std::size_t(std::max(options_.candidates, 1) + 2)));
  std::vector<Candidate> found(entries_.size());
  run_tasks(int(entries_.size()), threads_, progress_, [&](int i, const std::function<void()>& poll) {
    const Entry& e = entries_[i];
    const spatial::Surface model = spatial::make_surface(database_.load(e.model), {}, "database");
    const spatial::TriangleTree tree(model);
    const std::vector<spatial::Sample>& samples = samples_[kFit];
    const align::Pose pose = align::icp(samples, tree, e.places[0].pose, icp_options(scale, 0.9, 1e-5), poll).pose;
    Candidate& c = found[i];
    c.model = e.model;
    c.score = score(pose, *e.raster, tree, true, kFit);
    c.placement = placement_of(pose, *e.raster);
  });
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  for (const Candidate& c : found) memory_.placements[c.model] = c.placement;
  return found;
}

}  // namespace

std::vector<Candidate> find_similar(const SearchQuery& query, const io::ModelDatabase& database,
                                    const SearchOptions& options, Progress& progress, SearchMemory* memory) {
  SearchMemory own;
  return Searcher(query, database, options, progress, memory ? *memory : own).run();
}

}  // namespace parts::search
