// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/mend.h"

#include <algorithm>
#include <optional>

#include "parts/mend/inner_wall.h"
#include "parts/mend/itself.h"
#include "parts/mend/small_holes.h"
#include "parts/mesh/attributes.h"

namespace parts::mend {
namespace {

using End = RegionReport::End;

// Without a database, by how much the scan's mirror image and other places of it may miss what is known, of what a
// smooth surface does: half of a face vouches for the other half, another place for little.
constexpr double kMirrorMisses = 0.85, kPlaceMisses = 0.5;
constexpr int kSymmetry = 5;  // per cent of the time, without a database

std::vector<search::Candidate> search_around(const Scan& scan, const Region& region, const io::ModelDatabase& database,
                                             const search::SearchOptions& options, search::SearchMemory& memory,
                                             Progress& progress) {
  search::SearchQuery query{scan.mesh(), region.box, {}};
  for (char flaw : flaw_flags(scan, region)) query.face_weight.push_back(flaw ? 0.f : 1.f);
  return search::find_similar(query, database, options, progress, &memory);
}

std::vector<Region> regions_of(const Scan& scan, const MendOptions& options, Progress& progress) {
  return options.fill ? hole_regions(scan, options.region) : flaw_regions(scan, options.region, progress);
}

/// Mends the regions of a scan one after the other.
class Mending {
 public:
  Mending(const Mesh& input, const io::ModelDatabase* database, const MendOptions& options, Progress& progress);
  Mended run();

 private:
  void close_small_holes();
  bool find_again(Region& region) const;
  void mend(std::size_t i, Progress part);
  Restored from_models(std::size_t i, const Region& region, Progress part);
  Restored found_and_pasted(std::size_t i, const Scan& scan, const Region& region, Progress part);
  Restored from_itself(std::size_t i, const Scan& scan, const Region& region, Progress part);
  Restored pasted(std::size_t i, const Scan& scan, const Region& region, std::vector<OwnPlace> places, Progress part);
  void accept(std::size_t i, Restored restored);
  bool changed_since(std::size_t i, std::size_t from) const;
  bool worth_another_try(std::size_t i) const;

  const io::ModelDatabase* database_;
  const MendOptions& options_;
  Progress& progress_;
  search::SearchOptions search_options_;
  RestoreOptions restore_options_;
  search::SearchMemory memory_;

  const Scan first_;
  Scan scan_;  ///< now
  std::vector<Region> regions_;
  std::optional<Itself> itself_;               ///< where there is no database
  std::vector<std::vector<Vec3>> other_wall_;  ///< per region: rim_in_other_wall()
  std::vector<Objection> objection_;           ///< to each region's best model
  std::vector<Box> changed_;                   ///< where patches were made, in their order
  std::vector<std::size_t> tried_;             ///< per region: how many of these there were when it was tried
  Mended out_;
};

Mending::Mending(const Mesh& input, const io::ModelDatabase* database, const MendOptions& options, Progress& progress)
    : database_(database),
      options_(options),
      progress_(progress),
      search_options_(options.search),
      restore_options_(options.restore),
      first_(input),
      scan_(first_),
      regions_(regions_of(first_, options, progress)),
      objection_(regions_.size(), Objection::NoSurface),
      tried_(regions_.size(), 0) {
  // More are blended than are tried as the base.
  restore_options_.tries = options.search.candidates;
  if (options.restore.fitting.fit_to_rim)
    search_options_.candidates = std::max(search_options_.candidates, options.restore.fitting.blend);
  out_.chains = first_.chains(), out_.crumbs = first_.crumbs();
  if (!database_) {
    Progress looking = progress_.part(0, kSymmetry);
    itself_.emplace(first_, regions_, options.search.threads, looking);
    restore_options_.fitting.blend = 1;
  }
  for (const Region& region : regions_) {
    other_wall_.push_back(rim_in_other_wall(first_, region));
    RegionReport report;
    report.edges = region.rims.empty() ? 0 : region.rims[0].size();
    report.center = region.box.center();
    report.not_meant = int(region.not_meant.size());
    out_.regions.push_back(report);
  }
}

void Mending::close_small_holes() {
  std::vector<mesh::Loop> rims;
  std::vector<std::size_t> small;
  for (std::size_t i = 0; i < regions_.size(); ++i)
    if (is_small(regions_[i].rims[0])) rims.push_back(regions_[i].rims[0]), small.push_back(i);
  SmallHoles done = close_small(first_, rims);
  for (std::size_t k = 0; k < small.size(); ++k)
    if (done.closed[k]) out_.regions[small[k]].end = End::Small;
  scan_ = std::move(done.scan);
}

/// The region in the scan as it is now: by the edges of its rims, and where its
/// flawed faces are. @return false: nothing of it is left
bool Mending::find_again(Region& region) const {
  if (!region.rims.empty()) {
    region.rims = rims_left(scan_.mesh(), first_.mesh(), region.rims);
    return !region.rims.empty();
  }
  const std::vector<char> flaw = flaw_flags(scan_, region);
  return region.flaw.empty() || std::find(flaw.begin(), flaw.end(), 1) != flaw.end();
}

void Mending::mend(std::size_t i, Progress part) {
  RegionReport& report = out_.regions[i];
  Region region = regions_[i];
  if (!find_again(region)) {
    report.end = End::WithOthers;
    return;
  }
  tried_[i] = changed_.size();
  try {
    accept(i, from_models(i, region, part));
  } catch (const NotMended& e) {
    report.left_because = e.what(), objection_[i] = e.objection;
  } catch (const UserError& e) {
    report.left_because = e.what();
  }
}

/// A hole through a wall whose outer side has been mended is mended from within.
Restored Mending::from_models(std::size_t i, const Region& region, Progress part) {
  if (!other_wall_[i].empty() && changed_since(i, 0)) {
    try {
      if (const std::optional<InnerWall> wall = inner_wall(scan_, region, other_wall_[i])) {
        Restored r = put_back(scan_, *wall, found_and_pasted(i, wall->scan, wall->region, part.part(0, 50)));
        const Trial whole{
            scan_.mesh(), region.rims, r.mesh, r.source, r.candidate, 1e300, restore_options_.fitting.threads};
        if (objection_to(whole) == Objection::None) return r;
      }
    } catch (const UserError&) {  // then as any other
    }
    part = part.part(50, 100);
  }
  return found_and_pasted(i, scan_, region, part);
}

/// Whether a patch has been made in the region, of those from number `from` on.
bool Mending::changed_since(std::size_t i, std::size_t from) const {
  return std::any_of(changed_.begin() + long(from), changed_.end(),
                     [&](const Box& b) { return b.intersects(regions_[i].box); });
}

Restored Mending::found_and_pasted(std::size_t i, const Scan& scan, const Region& region, Progress part) {
  if (!database_) return from_itself(i, scan, region, part);
  Progress searching = part.part(0, 50);
  std::vector<OwnPlace> places;
  for (const search::Candidate& c : search_around(scan, region, *database_, search_options_, memory_, searching))
    places.push_back({{mesh::transformed(database_->load(c.model), c.placement), database_->name(c.model)}, c.score});
  return pasted(i, scan, region, std::move(places), part.part(50, 100));
}

/// The mirror image first, else another place that is alike.
Restored Mending::from_itself(std::size_t i, const Scan& scan, const Region& region, Progress part) {
  Objection why = Objection::NoSurface;
  for (bool mirror : {true, false}) {
    Progress searching = part.part(30, 60);
    restore_options_.must_foretell = mirror ? kMirrorMisses : kPlaceMisses;
    try {
      std::vector<OwnPlace> places =
          mirror ? itself_->mirror_images(region) : itself_->similar_places(scan, region, search_options_, searching);
      if (!places.empty())
        return pasted(i, scan, region, std::move(places), mirror ? part.part(0, 30) : part.part(60, 100));
    } catch (const NotMended& e) {
      why = std::max(why, e.objection);
    } catch (const UserError&) {  // nothing that could be compared
    }
  }
  throw NotMended(std::string("Neither the scan's own mirror image nor another place of it shows what belongs ") +
                      (options_.fill ? "into the hole" : "in place of the flaw") +
                      (why == Objection::NoSurface ? "" : std::string(" (") + words(why) + ")") +
                      "; give a Database of models of the same kind.",
                  why);
}

Restored Mending::pasted(std::size_t i, const Scan& scan, const Region& region, std::vector<OwnPlace> places,
                         Progress part) {
  RegionReport& report = out_.regions[i];
  report.candidates.clear();
  std::vector<PlacedModel> models;
  for (OwnPlace& p : places) {
    report.candidates.push_back({p.model.name, p.score});
    models.push_back(std::move(p.model));
  }
  return mend_region(scan, region, models, restore_options_, part);
}

/// The scan from now on.
void Mending::accept(std::size_t i, Restored r) {
  RegionReport& report = out_.regions[i];
  report.end = End::Mended, report.restored = r.report, report.left_because.clear();
  const Ranked& used = report.candidates[r.report.model];
  out_.candidates.push_back({int(i), std::move(r.candidate), used.name, used.score});
  changed_.emplace_back();
  for (int f = 0; f < r.mesh.face_count(); ++f) {
    if (r.source[f] >= 0)
      r.source[f] = scan_.origin()[r.source[f]];
    else
      changed_.back().extend(r.mesh.face_box(f));
  }
  scan_ = Scan(std::move(r.mesh), std::move(r.source));
}

/// What no model has a surface for, as a neck, is not asked for again; else
/// where a patch has been made beside it since.
bool Mending::worth_another_try(std::size_t i) const {
  return out_.regions[i].end == End::Left && objection_[i] != Objection::NoSurface && changed_since(i, tried_[i]);
}

Mended Mending::run() {
  if (options_.fill) close_small_holes();
  std::vector<std::size_t> now;
  for (std::size_t i = 0; i < regions_.size(); ++i)
    if (out_.regions[i].end == End::Left) now.push_back(i);
  constexpr int kFirstRound = 90;  // per cent of the time
  for (const auto& [from, to] : {std::pair(database_ ? 0 : kSymmetry, kFirstRound), std::pair(kFirstRound, 100)}) {
    const int n = int(now.size());
    for (int k = 0; k < n; ++k)
      mend(now[k], progress_.part(from + (to - from) * k / n, from + (to - from) * (k + 1) / n));
    now.erase(std::remove_if(now.begin(), now.end(), [&](std::size_t i) { return !worth_another_try(i); }), now.end());
  }
  if (out_.count(End::Left) == int(regions_.size())) throw UserError(out_.regions.back().left_because);
  out_.mesh = scan_.mesh();
  out_.mesh.vertex_selected.clear();
  out_.mesh.face_selected.clear();
  for (int o : scan_.origin()) out_.mesh.face_selected.push_back(o < 0);
  return std::move(out_);
}

std::string counted(int n, const std::string& what) { return std::to_string(n) + " " + what + (n == 1 ? "" : "s"); }

std::string rounded(const Vec3& p) {
  char text[96];
  std::snprintf(text, sizeof text, "%.4g, %.4g, %.4g", p.x(), p.y(), p.z());
  return text;
}

}  // namespace

int Mended::count(RegionReport::End end) const {
  return int(std::count_if(regions.begin(), regions.end(), [&](const RegionReport& r) { return r.end == end; }));
}

std::string summary(const Mended& mended, bool fill) {
  const int all = int(mended.regions.size()), done = all - mended.count(End::Left);
  std::string text =
      std::to_string(done) + " of " + counted(all, fill ? "hole" : "flaw") + (fill ? " filled" : " restored");
  int not_meant = 0;
  for (const RegionReport& r : mended.regions) {
    not_meant += r.not_meant;
    if (r.end == End::Left)
      text += "; the " + (r.edges ? "hole of " + counted(r.edges, "edge") : std::string("flaw")) + " around (" +
              rounded(r.center) + ") stays as it was: " + r.left_because.substr(0, r.left_because.find(';'));
  }
  if (not_meant)
    text += "; " + counted(not_meant, "selected face") +
            " behind a flaw, or of a piece that is only partly selected, stay as they were";
  if (fill && mended.chains)
    text += "; " + counted(mended.chains, "border") +
            " that end at edges of more than two faces bound no hole and stay open";
  if (mended.crumbs)
    text += "; " + counted(mended.crumbs, "face") + " that hung on the rest in a vertex only were left out";
  return text + ".";
}

std::vector<Found> find_models(const Mesh& input, const io::ModelDatabase* database, const MendOptions& options,
                               Progress& progress) {
  const Scan scan(input);
  const std::vector<Region> regions = regions_of(scan, options, progress);
  std::optional<Itself> itself;
  if (!database) itself.emplace(scan, regions, options.search.threads, progress);
  std::vector<Found> all;
  search::SearchMemory memory;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    Progress part = progress.part(int(100 * i / regions.size()), int(100 * (i + 1) / regions.size()));
    const auto add = [&](Mesh mesh, const std::string& name, double score) {
      all.push_back({int(i), std::move(mesh), name, score});
    };
    if (database)
      for (const search::Candidate& c : search_around(scan, regions[i], *database, options.search, memory, part))
        add(mesh::transformed(database->load(c.model), c.placement), database->name(c.model), c.score);
    else
      for (OwnPlace& p : itself->places(scan, regions[i], options.search, part))
        add(std::move(p.model.mesh), p.model.name, p.score);
  }
  if (all.empty())
    throw UserError(
        "The scan has neither a mirror image nor another place like the one around the region; give a "
        "Database of models of the same kind.");
  return all;
}

Mended mend_scan(const Mesh& scan, const io::ModelDatabase* database, const MendOptions& options, Progress& progress) {
  return Mending(scan, database, options, progress).run();
}

}  // namespace parts::mend
