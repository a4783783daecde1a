// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/restore.h"

#include <algorithm>

#include "parts/base/parallel.h"
#include "parts/compose/compose.h"
#include "parts/mend/blend.h"
#include "parts/mend/fit_to_rim.h"
#include "parts/mend/flaw.h"
#include "parts/mend/paste.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/prepare.h"
#include "parts/mesh/topology.h"
#include "parts/spatial/closest_face.h"

namespace parts::mend {
namespace {

constexpr double kAround = 0.8;  // of the region's size

Vec3 center_of(const Mesh& m, int f) { return (m.corner(f, 0) + m.corner(f, 1) + m.corner(f, 2)) / 3; }

/// How far around a region models and scan are compared.
Box around(const Region& region, double share) {
  Box box = region.box;
  box.min().array() -= share * region.size(), box.max().array() += share * region.size();
  return box;
}

/// What of a model can matter.
Mesh surroundings(const Mesh& model, const Region& region) {
  const Box box = around(region, kAround);
  std::vector<char> in(model.faces.size());
  for (int f = 0; f < model.face_count(); ++f) in[f] = box.intersects(model.face_box(f));
  return mesh::take_faces(model, in);
}

/// Turns a model over if most of it faces the other way than the scan beside it.
void agree_on_sides(Mesh& model, const spatial::ClosestFace& on_scan, double near) {
  double balance = 0;
  for (int f = 0; f < model.face_count(); ++f) {
    const Vec3 n = (model.corner(f, 1) - model.corner(f, 0)).cross(model.corner(f, 2) - model.corner(f, 0));
    const spatial::FaceHit hit = on_scan(center_of(model, f));
    if (!hit.on_border && hit.distance < near) balance += n.dot(hit.normal);
  }
  if (balance < 0) mesh::flip_orientation(model);
}

/// A model brought to the scan: rigidly, then smoothly.
struct Candidate {
  bool done = false;
  PosedModel posed;
  Fitted fitted;  ///< without its vertices, which posed has
  bool fits() const { return fitted.share > 0.6 && !posed.mesh.faces.empty(); }
};

/// What is pasted into the scan.
struct Fit {
  int model = -1;
  Mesh mesh;
  Fitted fitted;
  int blended = 1;
};

class Mender {
 public:
  Mender(const Mesh& scan, const Region& region, const std::vector<PlacedModel>& models, const RestoreOptions& options,
         Progress& progress)
      : scan_(scan), region_(region), models_(models), options_(options), progress_(progress) {}

  Restored restore();
  Restored fill();

 private:
  bool blends() const { return options_.fit_to_rim && options_.blend > 1; }
  void bring(Candidate& candidate, int model, const FitTarget& target) const;
  void bring_first(int count, const FitTarget& target);
  Fit fit(int model, const FitTarget& target);
  PasteOptions paste_options() const;
  /// Pastes into a scan with a hole. @param whole  the scan's face numbers before, for the report
  /// The published cut: compose() with these faces of the scan kept, and those
  /// of the model that the distances of Fig. 7 give.
  Restored thesis_cut(const Fit& fit, const std::vector<char>& keep, const std::vector<char>& keep_of_model) const;
  std::vector<char> far_from_scan(const Mesh& model) const;
  std::vector<char> near_centre(const Mesh& model) const;
  bool paste_into(const Mesh& open, const std::vector<mesh::Loop>& rims, const Fit& fit, Restored& out) const;

  const Mesh& scan_;
  const Region& region_;
  const std::vector<PlacedModel>& models_;
  const RestoreOptions& options_;
  Progress& progress_;
  std::vector<Candidate> candidates_;  ///< of each model, once it was asked for
};

void Mender::bring(Candidate& candidate, int model, const FitTarget& target) const {
  candidate.done = true;
  Mesh& mesh = candidate.posed.mesh;
  mesh = surroundings(mesh::prepare(models_[model].mesh).mesh, region_);
  if (mesh.faces.empty()) return;
  agree_on_sides(mesh, target.closest(), 0.5 * region_.size());
  FitOptions o;
  o.threads = 1;
  o.rigid = options_.refine;
  o.scale = options_.allow_scale;
  o.smooth = false;
  Progress silent;
  candidate.fitted = fit_to_rim(mesh, target, o, silent);
  mesh.vertices = candidate.fitted.vertices;
  if (options_.fit_to_rim) {
    const double before = candidate.fitted.rms_before;
    o.rigid = false, o.smooth = true;
    if (blends()) o.finest = 0.12;  // the blend is fitted once more
    candidate.fitted = fit_to_rim(mesh, target, o, silent);
    candidate.posed.rms = candidate.fitted.rms_before;
    candidate.fitted.rms_before = before;
  }
  candidate.posed.fitted = std::move(candidate.fitted.vertices);
}

/// Brings the first models, as far as they were not brought yet.
void Mender::bring_first(int count, const FitTarget& target) {
  candidates_.resize(models_.size());
  count = std::min(count, int(models_.size()));
  std::vector<int> missing;
  for (int m = 0; m < count; ++m)
    if (!candidates_[m].done) missing.push_back(m);
  // In bands of the cores, so that cancelling waits for one band only.
  const std::size_t band = std::size_t(thread_count(options_.threads));
  for (std::size_t first = 0; first < missing.size(); first += band) {
    progress_.at(0.4 * double(first) / double(missing.size()));
    parallel_for(long(std::min(band, missing.size() - first)), options_.threads, [&](long begin, long end) {
      for (long i = begin; i < end; ++i) bring(candidates_[missing[first + i]], missing[first + i], target);
    });
  }
}

Fit Mender::fit(int model, const FitTarget& target) {
  Fit f;
  f.model = model;
  bring_first(std::max(model + 1, blends() ? options_.blend : 1), target);
  const Candidate& own = candidates_[model];
  f.mesh = own.posed.mesh, f.fitted = own.fitted;
  if (f.mesh.faces.empty() || target.empty()) return f;
  f.mesh.vertices = own.posed.fitted;
  if (blends()) {
    std::vector<PosedModel> posed{own.posed};
    for (int m = 0; m < int(candidates_.size()) && int(posed.size()) < options_.blend; ++m)
      if (const Candidate& c = candidates_[m];
          m != model && c.done && c.fits() && c.fitted.rms_after < 0.05 * target.size())
        posed.push_back(c.posed);
    Blended blended = blend_models(posed, target, options_.threads, progress_);
    f.blended = blended.models;
    if (blended.models > 1) f.mesh.vertices = std::move(blended.vertices);
    FitOptions o;
    o.rigid = false;
    o.threads = options_.threads;
    const double before = f.fitted.rms_before;
    Progress silent;
    f.fitted = fit_to_rim(f.mesh, target, o, silent);
    f.fitted.rms_before = before;
    f.mesh.vertices = f.fitted.vertices;
  }
  if (!f.mesh.vertex_normal.empty()) mesh::update_normals(f.mesh);
  return f;
}

PasteOptions Mender::paste_options() const {
  PasteOptions o;
  o.size = region_.size();
  o.tolerance = (options_.fit_to_rim ? 0.1 : 0.3) * region_.size();
  o.smoothing = options_.smoothing;
  o.threads = options_.threads;
  return o;
}

bool Mender::paste_into(const Mesh& open, const std::vector<mesh::Loop>& rims, const Fit& fit, Restored& out) const {
  Mesh mesh = open;
  std::vector<char> tag(open.faces.size(), 0);
  RestoreReport& r = out.report;
  r = {};
  for (std::vector<mesh::Loop> left = rims; !left.empty(); left = rims_left(mesh, open, rims)) {
    Pasted p = paste(mesh, fit.mesh, left[0], paste_options());
    if (!p.closed) return false;
    r.rims_joined += p.joined, r.borders_capped += p.capped, r.islands_dropped += p.islands;
    r.seam_length += p.seam_length, r.seam_gap = std::max(r.seam_gap, p.seam_gap);
    // What was pasted before is the scan of this one.
    std::vector<char> merged(p.mesh.faces.size(), 0);
    for (std::size_t f = 0; f < merged.size(); ++f) merged[f] = p.face_from_model[f];
    if (std::find(tag.begin(), tag.end(), 1) != tag.end() && p.islands == 0)
      for (std::size_t f = 0; f < tag.size() && f < merged.size(); ++f)
        if (!merged[f]) merged[f] = tag[f];
    mesh = std::move(p.mesh), tag = std::move(merged);
  }
  r.model = fit.model, r.blended = fit.blended;
  r.rms_before = fit.fitted.rms_before, r.rms_after = fit.fitted.rms_after, r.inlier_share = fit.fitted.share;
  r.faces_added = int(std::count_if(tag.begin(), tag.end(), [](char t) { return t != 0; }));
  r.faces_replaced = scan_.face_count() - (mesh.face_count() - r.faces_added);
  out.mesh = std::move(mesh), out.face_from_model = std::move(tag);
  out.candidate = fit.mesh;
  return true;
}

/// Fig. 7b: the model's faces in the region whose distance from the scan is a
/// large share of the largest.
std::vector<char> Mender::far_from_scan(const Mesh& model) const {
  const spatial::ClosestFace on_scan(scan_);
  std::vector<double> distance(model.faces.size(), 0);
  double most = 0;
  for (int f = 0; f < model.face_count(); ++f) {
    if (!region_.box.contains(model.face_box(f))) continue;
    const spatial::FaceHit hit = on_scan(center_of(model, f));
    if (hit.on_border) most = std::max(most, distance[f] = hit.distance);
  }
  std::vector<char> keep(model.faces.size());
  for (std::size_t f = 0; f < keep.size(); ++f) keep[f] = distance[f] > options_.constraint_distance * most;
  return keep;
}

/// Fig. 7a: the model's faces nearest the centre, or over the selected flaw.
std::vector<char> Mender::near_centre(const Mesh& model) const {
  std::vector<char> keep(model.faces.size(), 0);
  const spatial::ClosestFace on_scan(scan_);
  const Vec3 half = region_.box.sizes() / 2;
  std::vector<double> away(model.faces.size());
  for (int f = 0; f < model.face_count(); ++f)
    away[f] = (center_of(model, f) - region_.box.center()).cwiseQuotient(half).norm();
  const double least = *std::min_element(away.begin(), away.end());
  for (int f = 0; f < model.face_count(); ++f) {
    if (!region_.box.contains(model.face_box(f))) continue;
    const bool over_flaw = !region_.flaw.empty() && region_.flaw[on_scan(center_of(model, f)).face];
    keep[f] = region_.flaw.empty() ? away[f] <= std::max(least, options_.constraint_distance) : over_flaw;
  }
  return keep;
}

Restored Mender::thesis_cut(const Fit& fit, const std::vector<char>& keep,
                            const std::vector<char>& keep_of_model) const {
  compose::ComposeOptions o;
  o.resolution = options_.resolution;
  o.cut = cut::Cut::Thesis;
  o.smoothing = options_.smoothing;
  o.volume = region_.box;
  o.threads = options_.threads;
  Progress part = progress_.part(50, 100);
  compose::ComposeResult composed =
      compose::compose({scan_, keep, "the scan"}, {fit.mesh, keep_of_model, "the model of the database"}, o, part);
  const mesh::MeshCheck before = mesh::check(scan_), after = mesh::check(composed.composed);
  const int wanted = before.boundary_loops - int(region_.rims.size());
  if (after.boundary_loops > wanted || after.nonmanifold_edges > before.nonmanifold_edges ||
      after.components > before.components)
    throw UserError(
        "The cut of the thesis does not close the surface here; choose the cut Mesh, or another Resolution.");
  Restored out;
  RestoreReport& r = out.report;
  r.model = fit.model, r.blended = fit.blended;
  r.rms_before = fit.fitted.rms_before, r.rms_after = fit.fitted.rms_after, r.inlier_share = fit.fitted.share;
  r.faces_added =
      int(std::count_if(composed.face_from_b.begin(), composed.face_from_b.end(), [](char t) { return t != 0; }));
  r.faces_replaced = std::max(0, scan_.face_count() - (composed.composed.face_count() - r.faces_added));
  r.rims_joined = composed.report.loops_joined, r.borders_capped = composed.report.loops_capped;
  r.seam_length = composed.report.seam_length, r.seam_gap = composed.report.seam_gap;
  out.mesh = std::move(composed.composed), out.face_from_model = std::move(composed.face_from_b);
  out.candidate = fit.mesh;
  return out;
}

Restored Mender::fill() {
  Restored out;
  const std::vector<char> no_flaw;
  const FitTarget target(scan_, no_flaw, around(region_, 2 * kAround), region_.size());
  const int tries = std::min(options_.tries, int(models_.size()));
  for (int m = 0; m < tries; ++m) {
    progress_.at(double(m) / tries);
    const Fit f = fit(m, target);
    if (f.mesh.faces.empty()) continue;
    if (options_.cut == cut::Cut::Thesis)
      return thesis_cut(f, flaw_constraints(scan_, region_, options_.constraint_distance).keep, far_from_scan(f.mesh));
    if (paste_into(scan_, region_.rims, f, out)) return out;
  }
  throw UserError(
      "No model of the database continues the scan over the hole; choose a database with such a surface, raise the "
      "number of Candidates, or give a region with more good surface around the hole.");
}

Restored Mender::restore() {
  Restored out;
  const FlawConstraints constraints = flaw_constraints(scan_, region_, options_.constraint_distance);
  if (std::find(constraints.flaw.begin(), constraints.flaw.end(), 1) == constraints.flaw.end())
    throw UserError("No whole face of the scan lies in the region; enlarge the box around the flaw.");
  const FitTarget target(scan_, constraints.suspect, around(region_, 2 * kAround), region_.size());
  const int tries = std::min(options_.tries, int(models_.size()));
  for (int m = 0; m < tries; ++m) {
    progress_.at(double(m) / tries);
    const Fit f = fit(m, target);
    if (f.mesh.faces.empty()) continue;
    if (options_.cut == cut::Cut::Thesis) return thesis_cut(f, constraints.keep, near_centre(f.mesh));
    const std::vector<char> replaced = cut_out_flaw(scan_, region_, constraints, f.mesh);
    std::vector<char> stays(replaced.size());
    for (std::size_t k = 0; k < stays.size(); ++k) stays[k] = !replaced[k];
    if (std::find(stays.begin(), stays.end(), 1) == stays.end()) continue;
    std::vector<int> old_vertex;
    const Mesh open = mesh::take_faces(scan_, stays, &old_vertex);
    // Rims that the cut has opened.
    std::vector<char> beside(scan_.vertices.size(), 0);
    for (int k = 0; k < scan_.face_count(); ++k)
      if (replaced[k])
        for (int v : scan_.faces[k]) beside[v] = 1;
    std::vector<mesh::Loop> rims;
    for (const mesh::Loop& l : find_rims(open))
      if (std::any_of(l.vertices.begin(), l.vertices.end(), [&](int v) { return beside[old_vertex[v]] != 0; }))
        rims.push_back(l);
    if (rims.empty()) continue;
    // The longest first: the patch that fills it may reach the others.
    std::stable_sort(rims.begin(), rims.end(), [&](const mesh::Loop& a, const mesh::Loop& b) {
      return mesh::loop_length(open, a) > mesh::loop_length(open, b);
    });
    if (paste_into(open, rims, f, out)) return out;
  }
  throw UserError(
      "No model of the database fits the surface around the flaw; choose a database with such a surface, raise the "
      "number of Candidates, or give a region with more good surface around the flaw.");
}

void check(const RestoreOptions& o, const std::vector<PlacedModel>& models) {
  if (models.empty()) throw UserError("There is no model to mend the scan with; choose another database.");
  if (!(o.constraint_distance > 0 && o.constraint_distance < 1))
    throw UserError("ConstraintDistance must lie between 0 and 1, both excluded.");
}

}  // namespace

Restored restore_surface(const Mesh& scan, const Region& region, const std::vector<PlacedModel>& models,
                         const RestoreOptions& options, Progress& progress) {
  check(options, models);
  return region.rims.empty() ? Mender(scan, region, models, options, progress).restore()
                             : Mender(scan, region, models, options, progress).fill();
}

Restored fill_hole(const Mesh& scan, const Region& region, const std::vector<PlacedModel>& models,
                   const RestoreOptions& options, Progress& progress) {
  check(options, models);
  if (region.rims.empty()) throw UserError("There is no hole in the region; use Restore Surface for flaws.");
  return Mender(scan, region, models, options, progress).fill();
}

}  // namespace parts::mend
