// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/restore.h"

#include <algorithm>
#include <cmath>

#include "parts/mend/flaw.h"
#include "parts/mend/foresight.h"
#include "parts/mend/paste.h"
#include "parts/mend/patch_color.h"
#include "parts/mend/thesis_cut.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/self_intersections.h"
#include "parts/spatial/closest_face.h"

namespace parts::mend {
namespace {

/// A scan with the holes that are to be closed.
struct Opened {
  Mesh mesh;
  std::vector<int> source;  ///< per face: its number in the scan
  std::vector<mesh::Loop> rims;
  std::vector<char> crossed;  ///< per face: of a piece that what was cut out has crossed; empty: none
};

/// Per face of a scan: of another piece that the faces to be replaced cross, as lids do an eyeball.
std::vector<char> pieces_crossed(const Scan& scan, const std::vector<char>& replaced, int threads) {
  const Mesh& mesh = scan.mesh();
  Box box;
  for (int f = 0; f < mesh.face_count(); ++f)
    if (replaced[f]) box.extend(mesh.face_box(f));
  std::vector<char> around(mesh.faces.size()), piece(mesh.vertices.size(), 0), flags;
  for (int f = 0; f < mesh.face_count(); ++f) around[f] = box.intersects(mesh.face_box(f));
  std::vector<int> old_face;
  const Mesh there = mesh::take_faces(mesh, around, nullptr, &old_face);
  const auto component = [&](int f) { return scan.component()[mesh.faces[f][0]]; };
  for (const auto& [a, b] : mesh::intersecting_faces(there, 0, threads)) {
    const int f = old_face[a], g = old_face[b];
    if (component(f) == component(g)) continue;
    if (replaced[f]) piece[component(g)] = 1;
    if (replaced[g]) piece[component(f)] = 1;
  }
  // Not the piece that is mended.
  for (int f = 0; f < mesh.face_count(); ++f)
    if (replaced[f]) piece[component(f)] = 0;
  for (int f = 0; f < mesh.face_count(); ++f) flags.push_back(piece[component(f)]);
  return flags;
}

/// Whole pieces of a scan that were selected with the flaw around them, but
/// have their like in the model (an eyeball behind its lids), stay.
/// @param near      how far from the model, on average, world units
/// @param replaced  per face
void keep_what_agrees(const Scan& scan, const Mesh& model, double near, std::vector<char>& replaced) {
  const Mesh& mesh = scan.mesh();
  std::vector<int> count(mesh.vertices.size(), 0);  // per component: faces to be replaced
  std::vector<double> away(mesh.vertices.size(), 0);
  const auto component = [&](int f) { return scan.component()[mesh.faces[f][0]]; };
  const auto whole = [&](int f) { return count[component(f)] == scan.component_faces()[mesh.faces[f][0]]; };
  for (int f = 0; f < mesh.face_count(); ++f) count[component(f)] += replaced[f];
  const spatial::ClosestFace on_model(model);
  if (on_model.empty()) return;
  int hint = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    if (replaced[f] && whole(f)) away[component(f)] += on_model(mesh.center(f), hint).distance;
  for (int f = 0; f < mesh.face_count(); ++f)
    if (replaced[f] && whole(f) && away[component(f)] <= near * count[component(f)]) replaced[f] = 0;
}

class Mender {
 public:
  Mender(const Scan& scan, const Region& region, const std::vector<PlacedModel>& models, const RestoreOptions& options)
      : scan_(scan), region_(region), models_(models), options_(options), flaw_(flaw_flags(scan, region)) {}

  Restored operator()(Progress& progress);

 private:
  bool fills() const { return !region_.rims.empty(); }
  FlawConstraints constraints() const;
  Opened opened(const Fit& fit, const FlawConstraints& constraints) const;
  Objection attempt(const Opened& opened, const Fit& fit, Restored& out) const;
  PasteOptions paste_options() const;
  [[noreturn]] void give_up(Objection why) const;

  const Scan& scan_;
  const Region& region_;
  const std::vector<PlacedModel>& models_;
  const RestoreOptions& options_;
  const std::vector<char> flaw_;  ///< per face of the scan
};

/// With a hole all of the scan is good, and what is kept matters to the thesis' cut only.
FlawConstraints Mender::constraints() const {
  FlawConstraints c = flaw_constraints(scan_.mesh(), region_, flaw_, options_.constraint_distance);
  if (fills())
    c.suspect.clear();
  else if (std::find(c.flaw.begin(), c.flaw.end(), 1) == c.flaw.end())
    throw UserError("No whole face of the scan lies in the region; enlarge the box around the flaw.");
  return c;
}

/// A hole is open; a flaw is cut out, the longest of the rims that this makes
/// first, since the patch that fills it may reach the others.
Opened Mender::opened(const Fit& fit, const FlawConstraints& constraints) const {
  const Mesh& scan = scan_.mesh();
  Opened o;
  if (fills()) {
    o.mesh = scan, o.rims = region_.rims;
    for (int f = 0; f < scan.face_count(); ++f) o.source.push_back(f);
    return o;
  }
  std::vector<char> replaced = cut_out_flaw(scan, region_, constraints, fit.mesh);
  keep_what_agrees(scan_, fit.mesh, 0.03 * region_.size(), replaced);
  std::vector<char> stays(replaced.size());
  for (std::size_t f = 0; f < stays.size(); ++f) stays[f] = !replaced[f];
  std::vector<int> old_vertex;
  o.mesh = mesh::take_faces(scan, stays, &old_vertex, &o.source);
  std::vector<char> beside(scan.vertices.size(), 0);
  for (int f = 0; f < scan.face_count(); ++f)
    if (replaced[f])
      for (int v : scan.faces[f]) beside[v] = 1;
  const std::vector<char> crossed = pieces_crossed(scan_, replaced, options_.fitting.threads);
  for (int f : o.source) o.crossed.push_back(crossed[f]);
  for (mesh::Loop& rim : find_rims(o.mesh))
    if (std::any_of(rim.begin(), rim.end(), [&](int v) { return beside[old_vertex[v]] != 0; }))
      o.rims.push_back(std::move(rim));
  std::stable_sort(o.rims.begin(), o.rims.end(), [&](const mesh::Loop& a, const mesh::Loop& b) {
    return mesh::loop_length(o.mesh, a) > mesh::loop_length(o.mesh, b);
  });
  return o;
}

PasteOptions Mender::paste_options() const {
  PasteOptions o;
  o.size = region_.size();
  o.tolerance = (options_.fitting.fit_to_rim ? 0.1 : 0.3) * region_.size();
  o.replace_islands = fills() || flaw_.empty();  // what is not selected is not the user's flaw
  o.smoothing = options_.smoothing;
  o.threads = options_.fitting.threads;
  return o;
}

/// Closes all rims with one model, and asks whether the result may stand.
Objection Mender::attempt(const Opened& opened, const Fit& fit, Restored& out) const {
  if (opened.rims.empty() || opened.mesh.faces.empty()) return Objection::NoSurface;
  const PasteOptions options = paste_options();
  out = {};
  out.mesh = opened.mesh, out.source = opened.source;
  std::vector<int> in_opened(opened.source.size());  // per face its number there
  for (std::size_t f = 0; f < in_opened.size(); ++f) in_opened[f] = int(f);
  RestoreReport& r = out.report;
  for (std::vector<mesh::Loop> left = opened.rims; !left.empty();
       left = rims_left(out.mesh, opened.mesh, opened.rims)) {
    Pasted p = paste(out.mesh, fit.mesh, left[0], options);
    if (!p.closed) return p.reached ? Objection::Open : Objection::NoSurface;
    r.rims_joined += p.joined, r.borders_capped += p.capped, r.islands_dropped += p.islands;
    r.seam_length += p.seam_length, r.seam_gap = std::max(r.seam_gap, p.seam_gap);
    std::vector<int> now;
    for (int s : p.source) now.push_back(s < 0 ? s : in_opened[s]);
    in_opened = std::move(now);
    out.mesh = std::move(p.mesh);
  }
  out.source.clear();
  for (int s : in_opened) out.source.push_back(s < 0 ? s : opened.source[s]);
  // What is joined to the rim may lie off the model by what the two differ there.
  const double edge = mesh::loop_length(opened.mesh, opened.rims[0]) / opened.rims[0].size();
  const double near = 0.03 * region_.size() + 4 * fit.fitted.rms_after + 0.25 * edge;
  return objection_to({opened.mesh, opened.rims, out.mesh, in_opened, fit.mesh, near, options.threads, opened.crossed});
}

void Mender::give_up(Objection why) const {
  const std::string what = fills() ? "the scan over the hole" : "the surface around the flaw";
  const std::string does = fills() ? "continues " : "fits ", where = fills() ? "hole" : "flaw";
  throw NotMended("No model of the database " + does + what +
                      (why == Objection::NoSurface ? "" : std::string(" (") + words(why) + ")") +
                      "; choose a database with such a surface, raise the number of Candidates, or give a region with "
                      "more good surface around the " +
                      where + ".",
                  why);
}

void measure(const Scan& scan, const Fit& fit, Restored& out) {
  RestoreReport& r = out.report;
  r.model = fit.model, r.blended = fit.blended;
  r.rms_before = fit.fitted.rms_before, r.rms_after = fit.fitted.rms_after, r.inlier_share = fit.fitted.share;
  r.faces_added = int(std::count_if(out.source.begin(), out.source.end(), [](int s) { return s < 0; }));
  r.faces_replaced = scan.mesh().face_count() - (int(out.source.size()) - r.faces_added);
}

Restored Mender::operator()(Progress& progress) {
  const FlawConstraints constraints = this->constraints();
  const FitTarget target(scan_.mesh(), constraints.suspect, around(region_, 2 * kAround), region_.size());
  ModelFitter fitter(models_, region_, target, options_.fitting);
  Objection best = Objection::NoSurface;
  const int tries = std::min(options_.tries, int(models_.size()));
  for (int m = 0; m < tries; ++m) {
    // Most often the first is accepted: it has most of the time.
    const auto percent = [](int done) { return int(100 * (1 - std::pow(0.4, done))); };
    Progress trying = progress.part(percent(m), percent(m + 1));
    Progress fitting = trying.part(0, 70), pasting = trying.part(70, 85);
    Fit fit = fitter(m, fitting);
    if (fit.mesh.faces.empty()) continue;
    take_kind_of_colors(scan_.mesh(), fit.mesh);
    pasting.stage("Joining model and scan", 0, 100);
    Restored out;
    if (options_.cut == cut::Cut::Thesis) {
      out = thesis_cut(scan_, region_, fit, constraints.keep, flaw_, options_, pasting);
    } else if (const Objection why = attempt(opened(fit, constraints), fit, out); why != Objection::None) {
      best = std::max(best, why);
      continue;
    }
    if (options_.must_foretell > 0) {
      Progress judging = trying.part(85, 100);
      const Foresight sight = foresee(scan_, region_, out, models_[m], options_.fitting, judging);
      if (!(sight.model <= options_.must_foretell * sight.fair)) {
        best = std::max(best, Objection::Unlike);
        continue;
      }
    }
    color_vertices_of_scan(scan_.mesh(), out.source, out.mesh);
    if (options_.match_color) match_colors(scan_.mesh(), fit.mesh, out.source, out.mesh);
    measure(scan_, fit, out);
    out.candidate = fit.mesh;
    return out;
  }
  give_up(best);
}

}  // namespace

Restored mend_region(const Scan& scan, const Region& region, const std::vector<PlacedModel>& models,
                     const RestoreOptions& options, Progress& progress) {
  if (models.empty()) throw UserError("There is no model to mend the scan with; choose another database.");
  if (!(options.constraint_distance > 0 && options.constraint_distance < 1))
    throw UserError("ConstraintDistance must lie between 0 and 1, both excluded.");
  return Mender(scan, region, models, options)(progress);
}

}  // namespace parts::mend
