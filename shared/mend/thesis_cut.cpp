// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/thesis_cut.h"

#include <algorithm>
#include <map>

#include "parts/base/error.h"
#include "parts/compose/compose.h"
#include "parts/spatial/closest_face.h"

namespace parts::mend {
namespace {

/// Fig. 7b: the model's faces in the region whose distance from the scan is a
/// large share of the largest.
std::vector<char> far_from_scan(const Mesh& scan, const Mesh& model, const Region& region, double share) {
  const spatial::ClosestFace on_scan(scan);
  std::vector<double> distance(model.faces.size(), 0);
  double most = 0;
  for (int f = 0; f < model.face_count(); ++f) {
    if (!region.box.contains(model.face_box(f))) continue;
    const spatial::FaceHit hit = on_scan(model.center(f));
    if (hit.on_border) most = std::max(most, distance[f] = hit.distance);
  }
  std::vector<char> keep(model.faces.size());
  for (std::size_t f = 0; f < keep.size(); ++f) keep[f] = distance[f] > share * most;
  return keep;
}

/// Fig. 7a: the model's faces nearest the centre, or over the selected flaw.
std::vector<char> near_centre(const Mesh& scan, const Mesh& model, const Region& region, const std::vector<char>& flaw,
                              double share) {
  std::vector<char> keep(model.faces.size(), 0);
  const spatial::ClosestFace on_scan(scan);
  const Vec3 half = region.box.sizes() / 2;
  std::vector<double> away(model.faces.size());
  for (int f = 0; f < model.face_count(); ++f)
    away[f] = (model.center(f) - region.box.center()).cwiseQuotient(half).norm();
  const double least = *std::min_element(away.begin(), away.end());
  for (int f = 0; f < model.face_count(); ++f) {
    if (!region.box.contains(model.face_box(f))) continue;
    const bool over_flaw = !flaw.empty() && flaw[on_scan(model.center(f)).face];
    keep[f] = flaw.empty() ? away[f] <= std::max(least, share) : over_flaw;
  }
  return keep;
}

/// Per face of what was composed: its number in the scan, if it is there bit for bit.
std::vector<int> sources(const Mesh& scan, const compose::ComposeResult& composed) {
  using Place = std::array<double, 9>;
  const auto place = [](const Mesh& m, int f) {
    Place p;
    for (int k = 0; k < 9; ++k) p[k] = m.corner(f, k / 3)[k % 3];
    return p;
  };
  std::map<Place, int> number;
  for (int f = 0; f < scan.face_count(); ++f) number[place(scan, f)] = f;
  std::vector<int> source;
  for (int f = 0; f < composed.composed.face_count(); ++f) {
    const auto at = number.find(place(composed.composed, f));
    if (composed.face_from_b[f] == 0 && at != number.end())
      source.push_back(at->second);
    else
      source.push_back(composed.face_from_b[f] == 1 ? kFromModel : kFromStitch);
  }
  return source;
}

}  // namespace

Restored thesis_cut(const Scan& scan, const Region& region, const Fit& fit, const std::vector<char>& keep,
                    const std::vector<char>& flaw, const RestoreOptions& options, Progress& progress) {
  const std::vector<char> keep_of_model =
      region.rims.empty() ? near_centre(scan.mesh(), fit.mesh, region, flaw, options.constraint_distance)
                          : far_from_scan(scan.mesh(), fit.mesh, region, options.constraint_distance);
  compose::ComposeOptions o;
  o.resolution = options.resolution;
  o.cut = cut::Cut::Thesis;
  o.smoothing = options.smoothing;
  o.volume = region.box;
  o.threads = options.fitting.threads;
  compose::ComposeResult composed = compose::compose(
      {scan.mesh(), keep, "the scan"}, {fit.mesh, keep_of_model, "the model of the database"}, o, progress);
  const mesh::MeshCheck before = mesh::check(scan.mesh()), after = mesh::check(composed.composed);
  const int wanted = before.boundary_loops - int(region.rims.size());
  if (after.boundary_loops > wanted || after.nonmanifold_edges > before.nonmanifold_edges ||
      after.components > before.components)
    throw UserError(
        "The cut of the thesis does not close the surface here; choose the cut Mesh, or another Resolution.");
  Restored out;
  out.report.rims_joined = composed.report.loops_joined, out.report.borders_capped = composed.report.loops_capped;
  out.report.seam_length = composed.report.seam_length, out.report.seam_gap = composed.report.seam_gap;
  out.source = sources(scan.mesh(), composed);
  out.mesh = std::move(composed.composed);
  return out;
}

}  // namespace parts::mend
