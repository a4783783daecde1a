// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/compose.h"

#include <chrono>
#include <memory>

#include "parts/cut/crossings.h"
#include "parts/cut/decision.h"
#include "parts/cut/rasterize.h"
#include "parts/cut/transition.h"
#include "parts/cut/transition_surface.h"
#include "parts/cut/volume.h"
#include "parts/mesh/attributes.h"
#include "parts/seam/clip.h"
#include "parts/seam/joined.h"

namespace parts::compose {
namespace {

class Clock {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

cut::Transition make_transition(const cut::Model& a, const cut::Model& b, const cut::Decision& d, cut::Cut cut) {
  if (cut == cut::Cut::Thesis) return cut::Transition::along_voxels(d.voxels, d.labels);
  return cut::Transition::smooth(d.voxels, d.labels,
                                 cut::crossing_points(a.prepared.mesh, b.prepared.mesh, d.voxels, d.labels));
}

seam::Clipped clip_model(const cut::Model& model, bool of_a, const cut::Decision& d, const cut::Transition& transition,
                         cut::Cut cut, int threads) {
  const Mesh& mesh = model.prepared.mesh;
  const cut::Grid& grid = d.voxels.grid;
  std::vector<signed char> pinned(mesh.faces.size(), 0);
  for (std::size_t f = 0; f < pinned.size(); ++f)
    if (model.keep[f])
      pinned[f] = 1;
    else if (const int piece = model.piece[f]; piece >= 0)
      pinned[f] = (d.labels.outer[piece] == cut::VoxelLabels::kA) == of_a ? 1 : -1;
  seam::ClipField field;
  const double sign = of_a ? 1 : -1;
  field.value = [&transition, sign, of_a](const Vec3& p) { return sign * transition.value(p, of_a); };
  field.crosses = [&transition, &grid, of_a](const Mesh& m, int f) {
    bool near = false;
    cut::for_each_voxel(grid, m, f, [&](std::size_t v) { near |= transition.near(v, of_a); });
    return near;
  };
  field.crumb = 1.5 * grid.size;
  field.max_edge = grid.size * (cut == cut::Cut::Thesis ? 0.5 : 1.0);
  return seam::clip(mesh, pinned, field, threads);
}

/// Everything at one resolution.
struct Attempt {
  cut::Decision decision;
  seam::Clipped a, b;
  seam::Joined joined;
  ComposeReport report;
  double flaws = 0;  ///< world units: borders that face none, and a voxel for each pair of crossing faces
};

std::unique_ptr<Attempt> attempt(cut::Model& a, cut::Model& b, const Box& volume, int resolution,
                                 const ComposeOptions& options, Progress& progress) {
  auto t = std::make_unique<Attempt>();
  progress.stage("Finding the minimal cut", 10, 50);
  t->decision = cut::decide(a, b, volume, resolution, options.cut, options.threads, t->report, progress);
  if (!t->decision.labels.connected) return t;
  progress.at(0.9);
  const cut::Transition transition = make_transition(a, b, t->decision, options.cut);
  progress.stage("Clipping", 50, 75);
  t->a = clip_model(a, true, t->decision, transition, options.cut, options.threads);
  progress.at(0.5);
  t->b = clip_model(b, false, t->decision, transition, options.cut, options.threads);
  progress.stage("Stitching and smoothing", 75, 95);
  t->joined = seam::join_parts(a, t->a, b, t->b);
  t->report.loops_a = int(t->joined.loops_a.size()), t->report.loops_b = int(t->joined.loops_b.size());
  if (!options.stitch) return t;
  const double voxel = t->report.voxel_size;
  t->flaws = seam::stitch_parts(t->joined, (3 + 2 * t->decision.reach) * voxel, t->report);
  progress.at(0.6);
  t->flaws += voxel * double(seam::finish_seam(t->joined, voxel, options.cut, options.smoothing, options.threads));
  t->report.blend = t->joined.blend;
  return t;
}

/// At the user's resolution; or at the natural one, coarser while the models do
/// not meet, finer while their constraints share a voxel or the seam has flaws.
std::unique_ptr<Attempt> best_attempt(cut::Model& a, cut::Model& b, const Box& volume, const ComposeOptions& options,
                                      Progress& progress) {
  constexpr int kCoarsest = 24, kFinest = 384, kFiner = 2;
  const UserError apart(
      "The models do not touch between what is to be kept of A and of B; move them closer until they overlap, or "
      "choose a lower Resolution.");
  if (options.resolution > 0) {
    auto t = attempt(a, b, volume, options.resolution, options, progress);
    if (!t->decision.labels.connected) throw apart;
    return t;
  }
  int resolution = cut::natural_resolution(a, b, volume);
  std::unique_ptr<Attempt> best;
  for (int finer = 0; finer <= kFiner;) try {
      auto t = attempt(a, b, volume, resolution, options, progress);
      if (!t->decision.labels.connected) {
        if (best) break;
        if (finer || resolution <= kCoarsest) throw apart;
        resolution = std::max(kCoarsest, resolution * 2 / 3);
        continue;
      }
      if (!best || t->flaws < best->flaws) best = std::move(t);
      if (best->flaws == 0 || resolution >= kFinest) break;
      resolution = std::min(kFinest, resolution * 8 / 5), ++finer;
    } catch (const cut::SharedVoxel&) {
      if (best) break;
      if (finer++ == kFiner || resolution >= kFinest) throw;
      resolution = std::min(kFinest, resolution * 2);
    } catch (const UserError&) {
      if (best) break;  // a finer grid that does not fit: what there is will do
      throw;
    }
  return best;
}

void check(const ComposeOptions& o) {
  if (o.resolution < 0) throw UserError("The Resolution is negative; give a number of voxels, or 0 for automatic.");
  if (o.smoothing.iterations < 0) throw UserError("SmoothIterations is negative; give 0 for no smoothing, or more.");
  if (!(o.smoothing.weight >= 0 && o.smoothing.weight <= 1))
    throw UserError("SmoothWeight must lie between 0 (vertices stay) and 1 (vertices go to their neighbours' mean).");
  if (!(o.smoothing.distance >= 0) || !std::isfinite(o.smoothing.distance))
    throw UserError("SmoothDistance must be a length of 0 or more; 0 means two voxels.");
  if (!(o.smoothing.blend_distance >= 0) || !std::isfinite(o.smoothing.blend_distance))
    throw UserError("BlendDistance must be a length of 0 or more; 0 chooses one.");
}

void log_notes(const cut::Model& m, const char* suffix, Progress& progress) {
  const auto say = [&](const char* what, int count) {
    if (count) progress.log(std::string(what) + suffix + ": " + std::to_string(count));
  };
  say("welded_vertices", m.prepared.welded_vertices);
  say("dropped_faces", m.prepared.dropped_faces);
  say("reversed_faces", m.prepared.reversed_faces);
}

/// Six times the volume that the closed components enclose, negative if they
/// are inside out; 0 if none is closed.
double enclosed(const mesh::Prepared& p) {
  const Vec3 origin = p.mesh.bounds().center();
  double sum = 0;
  for (int f = 0; f < p.mesh.face_count(); ++f)
    if (p.closed[p.component[f]])
      sum += (p.mesh.corner(f, 0) - origin).dot((p.mesh.corner(f, 1) - origin).cross(p.mesh.corner(f, 2) - origin));
  return sum;
}

}  // namespace

ComposeResult compose(const cut::Part& part_a, const cut::Part& part_b, const ComposeOptions& options,
                      Progress& progress) {
  const Clock clock;
  check(options);
  progress.stage("Preparing the models", 0, 10);
  cut::Model a = cut::make_model(part_a, part_a.name.empty() ? "model A" : part_a.name),
             b = cut::make_model(part_b, part_b.name.empty() ? "model B" : part_b.name);
  log_notes(a, "_A", progress), log_notes(b, "_B", progress);
  const Box volume = cut::transition_volume(a, b, options.volume);
  const bool turned = enclosed(a.prepared) * enclosed(b.prepared) < 0;
  if (turned) mesh::flip_orientation(b.prepared.mesh);

  const std::unique_ptr<Attempt> best = best_attempt(a, b, volume, options, progress);
  progress.stage("Finishing", 95, 100);
  ComposeResult result;
  result.report = best->report;
  result.report.reversed_b = best->report.reversed_b != turned;
  if (options.transition_surface)
    result.transition =
        cut::transition_surface(best->decision.voxels, best->decision.labels, options.cut == cut::Cut::Thesis ? 0 : 6);
  result.composed = std::move(best->joined.mesh);
  result.face_from_b = std::move(best->joined.tag);
  result.clipped_a = std::move(best->a.mesh), result.clipped_b = std::move(best->b.mesh);
  result.report.seconds = clock.seconds();
  progress.at(1.0);
  return result;
}

}  // namespace parts::compose
