// SPDX-License-Identifier: GPL-3.0-or-later
#include "database/search.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "align/coarse_poses.h"
#include "align/icp.h"
#include "align/tasks.h"
#include "database/correlation.h"
#include "database/model_cache.h"
#include "database/query_surface.h"
#include "geometry/error.h"
#include "geometry/parallel.h"

namespace parts {
namespace {

constexpr double kScaleStep = 1.2;  // from one scale of the coarsest search to the next
constexpr int kRotations = 96;      // tried for models that may lie any way

/// A scale of the search. `reach`: how far around the region the surface counts,
/// in its radii (QuerySurface::weight).
struct Scale {
  double reach;
  int samples, iterations;
  int places;  ///< of a model that go on to the next scale
};
constexpr Scale kScales[] = {{4, 160, 15, 4}, {3, 300, 15, 2}, {2, 600, 20, 1}};
constexpr Scale kFinal = {1.5, 1000, 30, 1};
constexpr double kFarthest = 0.35;  // radii of the region: distances count up to it
constexpr double kTurned = 0.1;     // what a normal across the other surface's costs, in kFarthest squared
constexpr int kPlaces = 10;         // of a model that the coarsest search proposes

/// Where a model may be: the query's frame in the model's.
struct Place {
  Pose pose;
  double score = 0;
};

struct Entry {
  int model = -1;
  const ModelRaster* raster = nullptr;
  Correlation::Model spectrum;
  double cell = 1;            ///< of the coarsest grid
  double unit = 1;            ///< the query's frame in the model's, where world units are the same
  std::vector<int> scales;    ///< to try, as powers of kScaleStep: voxels of the coarsest grid
  std::vector<Place> places;  ///< best first
  double score() const { return places.empty() ? INFINITY : places[0].score; }
};

void keep_best(std::vector<Place>& places, std::size_t most) {
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.score < b.score; });
  if (places.size() > most) places.resize(most);
}

Pose inverse(const Pose& p) {
  Pose q;
  q.rotation = p.rotation.transpose();
  q.scale = 1 / p.scale;
  q.translation = -q.scale * (q.rotation * p.translation);
  return q;
}

class Searcher {
 public:
  Searcher(const SearchQuery& query, const ModelDatabase& database, const SearchOptions& options, Progress& progress)
      : query_(query),
        database_(database),
        options_(options),
        progress_(progress),
        threads_(thread_count(options.threads)),
        levels_(std::clamp(options.levels, 1, int(std::size(kScales)))),
        cache_(database, {levels_, options.cache, options.threads}) {}

  std::vector<Candidate> run() {
    progress_.stage("Reading the models", 0, 50);
    cache_.fill(progress_);
    prepare();
    progress_.stage("Comparing everywhere", 50, 75);
    search_everywhere();
    drop_worse_half();
    for (int l = 1; l < levels_; ++l) {
      progress_.stage("Comparing more finely", 70 + 5 * l, 75 + 5 * l);
      refine(l);
      drop_worse_half();
    }
    progress_.stage("Fitting the best models", 85, 100);
    std::vector<Candidate> found = fit();
    progress_.at(1);
    return found;
  }

 private:
  void prepare();
  void choose_scales(Entry& e) const;
  std::vector<Eigen::Matrix3d> rotations() const;
  void search_everywhere();
  void propose(Entry& e, int scale, const Eigen::Matrix3d& rotation, const Correlation::Best& best) const;
  void refine(int level);
  void drop_worse_half();
  std::vector<Candidate> fit();
  double score(const Pose& pose, const ModelRaster& raster, const ClosestPoint& model, bool exact, int scale) const;

  const SearchQuery& query_;
  const ModelDatabase& database_;
  const SearchOptions& options_;
  Progress& progress_;
  int threads_, levels_;
  ModelCache cache_;
  std::unique_ptr<QuerySurface> surface_;
  std::vector<Sample> samples_[std::size(kScales) + 1];
  double area_[std::size(kScales) + 1] = {};
  std::vector<Entry> entries_;
};

void Searcher::prepare() {
  surface_ = std::make_unique<QuerySurface>(query_);
  for (std::size_t l = 0; l <= std::size(kScales); ++l) {
    const Scale& s = l < std::size(kScales) ? kScales[l] : kFinal;
    samples_[l] = surface_->samples(s.reach, l == 0 ? 4000 : s.samples);
    area_[l] = surface_->weighted_area(s.reach);
  }
  for (int m = 0; m < database_.size(); ++m) {
    if (!cache_.raster(m)) continue;
    Entry e;
    e.model = m;
    e.raster = cache_.raster(m);
    e.spectrum = Correlation::model(*e.raster);
    choose_scales(e);
    entries_.push_back(std::move(e));
  }
  if (entries_.empty()) throw UserError("No model of the database can be used; the log says why each was skipped.");
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
  if (options_.any_rotation)
    r = spread_rotations(kRotations - 1);
  else
    for (int i = 0; i < 11; ++i) {  // 25 degrees about axes spread over the sphere
      const double z = 1 - (2 * i + 1) / 11.0, a = 2.399963229728653 * i;
      const Vec3 axis(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z);
      r.push_back(Eigen::AngleAxisd(25 * M_PI / 180, axis).toRotationMatrix());
    }
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

void Searcher::search_everywhere() {
  const std::vector<Eigen::Matrix3d> turns = rotations();
  std::vector<Correlation::Point> points;
  for (const Sample& s : samples_[0])
    points.push_back({s.point - surface_->region().center(), 1 / surface_->weight(s.point, kScales[0].reach)});
  std::map<int, std::vector<Entry*>> by_scale;
  for (Entry& e : entries_)
    for (int s : e.scales) by_scale[s].push_back(&e);
  int done = 0;
  for (const auto& [scale, entries] : by_scale) {
    progress_.stage("Comparing everywhere", 50 + 15 * done / int(by_scale.size()),
                    50 + 15 * (done + 1) / int(by_scale.size()));
    ++done;
    const double to_voxels = std::pow(kScaleStep, scale);
    std::vector<Correlation::Query> queries(turns.size() / 2);
    run_tasks(int(queries.size()), threads_, progress_, [&](int i, const auto&) {
      queries[i] = Correlation::query(points, to_voxels * turns[2 * i], to_voxels * turns[2 * i + 1]);
    });
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
  progress_.stage("Comparing the best places", 65, 75);
  refine(0);
}

void Searcher::drop_worse_half() {
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.score() < b.score(); });
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

double Searcher::score(const Pose& pose, const ModelRaster& raster, const ClosestPoint& model, bool exact,
                       int scale_index) const {
  const Scale& scale = scale_index < int(std::size(kScales)) ? kScales[scale_index] : kFinal;
  const std::vector<Sample>& samples = samples_[scale_index];
  const double weighted_area = area_[scale_index];
  const double most = kFarthest * surface_->radius(), most2 = most * most;
  const double spacing = exact ? 0 : std::sqrt(raster.area / double(raster.samples.size()));
  int hint = 0;
  double forth = 0;
  const int n = std::min(scale.samples, int(samples.size()));
  for (int i = 0; i < n; ++i) {
    const Vec3 p = pose(samples[i].point);
    const Closest c = model.closest(p, hint);
    const double d2 = squared_distance(p, c.point, c.normal, spacing) / (pose.scale * pose.scale);
    const double turned = 1 - std::abs(c.normal.dot(pose.rotation * samples[i].normal));
    forth += std::min(d2, most2) + kTurned * most2 * turned;
  }
  forth *= weighted_area / n;
  double back = 0, back_area = 0;
  const Pose to_query = inverse(pose);
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

void Searcher::refine(int level) {
  const Scale& scale = kScales[level];
  const int grid = std::min(std::max(level, 1), levels_ - 1);
  run_tasks(int(entries_.size()), threads_, progress_, [&](int i, const std::function<void()>& poll) {
    Entry& e = entries_[i];
    if (grid > 1) cache_.complete(e.model);
    const RasterTarget target(*e.raster, grid);
    for (Place& p : e.places) {
      IcpOptions icp_options;
      icp_options.samples = scale.samples;
      icp_options.iterations = scale.iterations;
      icp_options.overlap = 0.8;
      icp_options.scale = options_.allow_scale;
      icp_options.done = 1e-3;
      p.pose = icp(samples_[level], target, p.pose, icp_options, poll).pose;
      p.score = score(p.pose, *e.raster, target, false, level);
    }
    keep_best(e.places, std::size_t(scale.places));
  });
}

std::vector<Candidate> Searcher::fit() {
  entries_.resize(std::min(entries_.size(), std::size_t(std::max(options_.candidates, 1) + 2)));
  std::vector<Candidate> found(entries_.size());
  run_tasks(int(entries_.size()), threads_, progress_, [&](int i, const std::function<void()>& poll) {
    const Entry& e = entries_[i];
    const Surface model = make_surface(database_.load(e.model), {}, "database");
    const TriangleTree tree(model);
    IcpOptions icp_options;
    icp_options.samples = kFinal.samples;
    icp_options.iterations = kFinal.iterations;
    icp_options.overlap = 0.9;
    icp_options.scale = options_.allow_scale;
    icp_options.done = 1e-5;
    const std::vector<Sample>& samples = samples_[std::size(kScales)];
    const Pose pose = icp(samples, tree, e.places[0].pose, icp_options, poll).pose;
    const Pose back = inverse(pose);
    Candidate& c = found[i];
    c.model = e.model;
    c.score = score(pose, *e.raster, tree, true, int(std::size(kScales)));
    const double world = back.scale * surface_->size() / model.size;
    c.placement.linear() = world * back.rotation;
    c.placement.translation() =
        surface_->origin() + surface_->size() * back.translation - c.placement.linear() * model.origin;
  });
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  found.resize(std::min(found.size(), std::size_t(std::max(options_.candidates, 1))));
  return found;
}

}  // namespace

std::vector<Candidate> find_similar(const SearchQuery& query, const ModelDatabase& database,
                                    const SearchOptions& options, Progress& progress) {
  return Searcher(query, database, options, progress).run();
}

}  // namespace parts
