// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/itself.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "parts/base/error.h"
#include "parts/mesh/attributes.h"

namespace parts::mend {
namespace {

constexpr int kPlanes = 4;  // that are tried

/// Per face of a scan: no region says that it is damaged. Where only the box
/// around a flaw is known, nothing in it is believed.
std::vector<char> sound_faces(const Scan& scan, const std::vector<Region>& regions) {
  std::vector<char> sound(scan.mesh().faces.size(), 1);
  for (const Region& region : regions) {
    if (!region.rims.empty()) continue;
    const std::vector<char> flaw = flaw_flags(scan, region);
    for (int f = 0; f < scan.mesh().face_count(); ++f)
      if (flaw.empty() ? region.box.intersects(scan.mesh().face_box(f)) : flaw[f] != 0) sound[f] = 0;
  }
  return sound;
}

/// Pieces of a surface about six times as wide as a region, spread evenly over
/// it: the search sees no detail that is small against a model.
std::vector<Mesh> tiles(const Mesh& mesh, double size) {
  constexpr double kRadius = 3, kSpacing = 1.5;  // of the region's size
  constexpr int kMost = 32;
  std::vector<Mesh> cut;
  std::vector<double> away(mesh.faces.size(), INFINITY);  // from the nearest tile's middle
  for (int next = 0; !mesh.faces.empty() && int(cut.size()) < kMost;) {
    const Vec3 middle = mesh.center(next);
    std::vector<char> in(mesh.faces.size());
    for (int f = 0; f < mesh.face_count(); ++f) {
      const double d = (mesh.center(f) - middle).norm();
      in[f] = d < kRadius * size, away[f] = std::min(away[f], d);
    }
    cut.push_back(mesh::take_faces(mesh, in));
    next = int(std::max_element(away.begin(), away.end()) - away.begin());
    if (away[next] < kSpacing * size) break;
  }
  return cut;
}

void log_plane(const align::Symmetry& s, Progress& progress) {
  const auto line = [&](const char* name, const char* format, auto... numbers) {
    char text[128];
    std::snprintf(text, sizeof text, format, numbers...);
    progress.log(std::string(name) + ": " + text);
  };
  line("symmetry_residual", "%.6g", s.residual);
  line("symmetry_normal", "%.6g %.6g %.6g", s.normal.x(), s.normal.y(), s.normal.z());
  line("symmetry_point", "%.6g %.6g %.6g", s.point.x(), s.point.y(), s.point.z());
}

}  // namespace

Itself::Itself(const Scan& scan, const std::vector<Region>& regions, int threads, Progress& progress) {
  progress.stage("Looking for symmetry", 0, 100);
  const std::vector<char> sound = sound_faces(scan, regions);
  sound_ = mesh::take_faces(scan.mesh(), sound);
  sound_.face_selected.clear(), sound_.vertex_selected.clear();
  if (sound_.faces.empty()) return;
  planes_ = align::find_symmetries(sound_, {}, kPlanes, threads, progress);
  if (!planes_.empty()) log_plane(planes_[0], progress);
  // As good as the best: an egg's planes are all alike, but a face's is one.
  const double good = planes_.empty() ? 0 : 2 * planes_[0].residual + 0.002 * planes_[0].size;
  planes_.erase(std::remove_if(planes_.begin(), planes_.end(),
                               [&](const align::Symmetry& s) { return !s.holds() || s.residual > good; }),
                planes_.end());
}

std::vector<OwnPlace> Itself::mirror_images(const Region& region) const {
  // A plane through the region mirrors what is missing onto itself.
  std::vector<align::Symmetry> planes = planes_;
  const auto through = [&](const align::Symmetry& s) { return s.distance(region.box.center()) < 0.5 * region.size(); };
  std::stable_partition(planes.begin(), planes.end(), [&](const align::Symmetry& s) { return !through(s); });
  std::vector<OwnPlace> images;
  for (const align::Symmetry& s : planes)
    images.push_back(
        {{mesh::transformed(sound_, s.reflection()), "the scan's own mirror image"}, s.residual / region.size()});
  return images;
}

std::vector<OwnPlace> Itself::similar_places(const Scan& now, const Region& region,
                                             const search::SearchOptions& options, Progress& progress) const {
  // What is asked for and what is looked through have no face in common, or the place itself would be found.
  const Box own = around(region, kAround);
  search::SearchQuery query{now.mesh(), region.box, {}};
  const std::vector<char> flaw = flaw_flags(now, region);
  for (int f = 0; f < now.mesh().face_count(); ++f)
    query.face_weight.push_back(own.intersects(now.mesh().face_box(f)) && (flaw.empty() || !flaw[f]) ? 1.f : 0.f);
  std::vector<char> elsewhere(sound_.faces.size());
  for (int f = 0; f < sound_.face_count(); ++f) elsewhere[f] = !own.intersects(sound_.face_box(f));
  const Mesh rest = mesh::take_faces(sound_, elsewhere);
  const std::vector<Mesh> cut = tiles(rest, region.size());
  if (cut.empty()) return {};
  Eigen::Affine3d flip = Eigen::Affine3d::Identity();
  flip(0, 0) = -1;
  std::vector<std::pair<std::string, Mesh>> models;
  for (std::size_t t = 0; t < cut.size(); ++t) {
    const std::string number = " " + std::to_string(t + 1);
    models.emplace_back("another place of the scan" + number, cut[t]);
    models.emplace_back("another place of the scan's mirror image" + number, mesh::transformed(cut[t], flip));
  }
  const io::ModelDatabase places(std::move(models));
  search::SearchOptions o = options;
  o.cache = false;
  std::vector<OwnPlace> found;
  for (const search::Candidate& c : search::find_similar(query, places, o, progress))
    if (c.score <= search::kDoubtful)
      found.push_back({{mesh::transformed(places.load(c.model), c.placement), places.name(c.model)}, c.score});
  return found;
}

std::vector<OwnPlace> Itself::places(const Scan& scan, const Region& region, const search::SearchOptions& options,
                                     Progress& progress) const {
  std::vector<OwnPlace> all = mirror_images(region);
  if (!all.empty()) all.resize(1);
  for (OwnPlace& p : similar_places(scan, region, options, progress)) all.push_back(std::move(p));
  if (int(all.size()) > options.candidates) all.resize(std::size_t(options.candidates));
  return all;
}

}  // namespace parts::mend
