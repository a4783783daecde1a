// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/fitting.h"

#include <algorithm>

#include "parts/base/parallel.h"
#include "parts/base/tasks.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/manifold.h"
#include "parts/mesh/slits.h"

namespace parts::mend {
namespace {

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
    const spatial::FaceHit hit = on_scan(model.center(f));
    if (!hit.on_border && hit.distance < near) balance += model.area_vector(f).dot(hit.normal);
  }
  if (balance < 0) mesh::flip_orientation(model);
}

}  // namespace

Box around(const Region& region, double share) {
  Box box = region.box;
  box.min().array() -= share * region.size(), box.max().array() += share * region.size();
  return box;
}

void ModelFitter::bring(int model) {
  Brought& brought = brought_[model];
  brought.done = true;
  Mesh& mesh = brought.posed.mesh;
  mesh = mesh::made_manifold(surroundings(mesh::prepare_without_slits(models_[model].mesh), region_));
  if (mesh.faces.empty()) return;
  if (!target_.empty()) agree_on_sides(mesh, target_.closest(), 0.5 * region_.size());
  FitOptions o;
  o.threads = 1;
  o.rigid = options_.refine;
  o.scale = options_.allow_scale;
  o.smooth = false;
  Progress silent;
  brought.fitted = fit_to_rim(mesh, target_, o, silent);
  mesh.vertices = brought.fitted.vertices;
  if (options_.fit_to_rim) {
    const double before = brought.fitted.rms_before;
    o.rigid = false, o.smooth = true;
    if (blends()) o.finest = 0.12;  // the blend is fitted once more
    brought.fitted = fit_to_rim(mesh, target_, o, silent);
    brought.posed.rms = brought.fitted.rms_before;
    brought.fitted.rms_before = before;
  }
  brought.posed.fitted = std::move(brought.fitted.vertices);
}

/// Brings the first models, as far as they were not brought yet.
void ModelFitter::bring_first(int count, Progress& progress) {
  count = std::min(count, int(models_.size()));
  std::vector<int> missing;
  for (int m = 0; m < count; ++m)
    if (!brought_[m].done) missing.push_back(m);
  run_tasks(int(missing.size()), thread_count(options_.threads), progress,
            [&](int i, const Poll&) { bring(missing[std::size_t(i)]); });
}

void ModelFitter::blend(Fit& fit, Progress& progress) {
  std::vector<PosedModel> posed{brought_[fit.model].posed};
  for (int m = 0; m < int(brought_.size()) && int(posed.size()) < options_.blend; ++m)
    if (const Brought& b = brought_[m];
        m != fit.model && b.done && b.fits() && b.fitted.rms_after < 0.05 * target_.size())
      posed.push_back(b.posed);
  Blended blended = blend_models(posed, target_, options_.threads, progress);
  fit.blended = blended.models;
  if (blended.models > 1) fit.mesh.vertices = std::move(blended.vertices);
  FitOptions o;
  o.rigid = false;
  o.threads = options_.threads;
  const double before = fit.fitted.rms_before;
  Progress silent;
  fit.fitted = fit_to_rim(fit.mesh, target_, o, silent);
  fit.fitted.rms_before = before;
  fit.mesh.vertices = fit.fitted.vertices;
}

Fit ModelFitter::operator()(int model, Progress& progress) {
  progress.stage("Fitting the models", 0, 50);
  bring_first(std::max(model + 1, blends() ? options_.blend : 1), progress);
  const Brought& own = brought_[model];
  Fit f;
  f.model = model;
  f.mesh = own.posed.mesh, f.fitted = own.fitted;
  if (f.mesh.faces.empty() || target_.empty()) return f;
  f.mesh.vertices = own.posed.fitted;
  if (blends()) blend(f, progress);
  if (!f.mesh.vertex_normal.empty()) mesh::update_normals(f.mesh);
  return f;
}

}  // namespace parts::mend
