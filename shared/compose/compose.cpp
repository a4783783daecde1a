// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/compose.h"

#include <chrono>
#include <optional>

#include "parts/compose/assemble.h"
#include "parts/compose/clip_border.h"
#include "parts/cut/decision.h"
#include "parts/cut/mesh_cut.h"
#include "parts/cut/rasterize.h"
#include "parts/cut/seam_score.h"
#include "parts/cut/transition.h"
#include "parts/cut/transition_surface.h"
#include "parts/cut/volume.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/loops.h"
#include "parts/mesh/topology.h"
#include "parts/seam/clip.h"
#include "parts/spatial/face_tree.h"

namespace parts::compose {
namespace {

class Clock {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The surface between what is left of the models, from their voxels.
Mesh surface_between(const Mesh& a, const Mesh& b, const Box& volume) {
  constexpr int kVoxels = 64, kSmoothing = 6;
  const cut::Grid grid = cut::Grid::over(volume, kVoxels);
  cut::JointVoxels voxels = cut::join(grid, cut::rasterize(a, {}, grid, 1), cut::rasterize(b, {}, grid, 1),
                                      cut::VoxelSet(grid.count()), cut::VoxelSet(grid.count()));
  cut::VoxelLabels labels;
  for (std::uint8_t flags : voxels.flags)
    labels.label.push_back(flags & cut::kHasA ? cut::VoxelLabels::kA : cut::VoxelLabels::kB);
  return cut::transition_surface(voxels, labels, kSmoothing);
}

Assembly by_mesh_cut(const cut::Model& a, const cut::Model& b, const Box& volume, const ComposeOptions& options,
                     Progress& progress) {
  Assembly t;
  progress.stage("Finding the minimal cut", 10, 60);
  cut::check_volume(a, volume), cut::check_volume(b, volume);
  const cut::MeshCut cut =
      cut::cut_meshes(a, b, volume, options.smoothing.blend, options.threads, t.result.report, progress);
  progress.stage("Clipping", 60, 75);
  const double crumb = 1.5 * cut.edge;
  seam::Clipped clipped[2] = {clip_border(cut.border[0], a.keep, crumb), clip_border(cut.border[1], b.keep, crumb)};
  const auto loops = [&](int side) { return int(mesh::trace_loops(clipped[side].border).size()); };
  if (loops(0) != cut.loops[0] || loops(1) != cut.loops[1]) {  // smoothing closed a border, or made one
    clipped[0] = clip_border(cut.raw_border(0), a.keep, crumb);
    clipped[1] = clip_border(cut.raw_border(1), b.keep, crumb);
  }
  if (options.transition_surface) t.result.transition = surface_between(clipped[0].mesh, clipped[1].mesh, volume);
  assemble(a, std::move(clipped[0]), b, std::move(clipped[1]), {cut.edge, 3 * cut.edge + 1.5 * cut.gap, cut.step},
           options, progress, t);
  return t;
}

seam::Clipped clip_by_voxels(const cut::Model& model, bool of_a, const cut::Decision& d,
                             const cut::Transition& transition, int threads) {
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
  field.max_edge = 0.5 * grid.size;
  return seam::clip(mesh, pinned, field, threads);
}

/// The thesis' cut, clip and stitch at one resolution; nothing past the cut where that finds none.
struct Attempt {
  cut::Decision::Outcome outcome;
  Assembly assembly;
};

Attempt at_resolution(cut::Model& a, cut::Model& b, const Box& volume, int resolution, const ComposeOptions& options,
                      Progress& progress) {
  Attempt attempt;
  Assembly& t = attempt.assembly;
  progress.stage("Finding the minimal cut", 10, 50);
  const cut::Decision d = cut::decide(a, b, volume, resolution, options.threads, t.result.report, progress);
  attempt.outcome = d.outcome;
  if (d.outcome != cut::Decision::Outcome::Cut) return attempt;
  const cut::Transition transition(d.voxels, d.labels);
  progress.stage("Clipping", 50, 75);
  seam::Clipped clipped_a = clip_by_voxels(a, true, d, transition, options.threads);
  progress.at(0.5);
  seam::Clipped clipped_b = clip_by_voxels(b, false, d, transition, options.threads);
  if (options.transition_surface) t.result.transition = cut::transition_surface(d.voxels, d.labels, 0);
  const double voxel = t.result.report.voxel_size;
  assemble(a, std::move(clipped_a), b, std::move(clipped_b), {voxel, 3 * voxel, 0}, options, progress, t);
  return attempt;
}

/// At the user's resolution; or at the natural one, coarser while the models do
/// not meet, finer while their constraints share a voxel or the seam has flaws.
Assembly by_voxel_cut(cut::Model& a, cut::Model& b, const Box& volume, const ComposeOptions& options,
                      Progress& progress) {
  constexpr int kCoarsest = 24, kFinest = 384, kMostFiner = 2;
  const bool fixed = options.resolution > 0;
  int resolution = fixed ? options.resolution : cut::natural_resolution(a, b, volume), finer = 0;
  std::optional<Assembly> best;
  while (true) {
    Attempt t = at_resolution(a, b, volume, resolution, options, progress);
    const bool finest = fixed || finer == kMostFiner || resolution >= kFinest;
    double step = 1.6;
    if (t.outcome == cut::Decision::Outcome::Cut) {
      if (!best || t.assembly.flaws < best->flaws) best = std::move(t.assembly);
      if (best->flaws == 0 || finest) return std::move(*best);
    } else if (best) {
      return std::move(*best);
    } else if (t.outcome == cut::Decision::Outcome::Apart) {
      if (fixed || finer > 0 || resolution <= kCoarsest)
        throw UserError(
            "The models do not touch between what is to be kept of A and of B; move them closer until they overlap, "
            "or choose a lower Resolution.");
      resolution = std::max(kCoarsest, resolution * 2 / 3);
      continue;
    } else {
      if (finest)
        throw UserError(
            "What is to be kept of the two models lies in the same voxel; mark parts farther apart, or raise the "
            "Resolution.");
      step = 2;
    }
    resolution = std::min(kFinest, int(resolution * step)), ++finer;
    if (best && !cut::fits_memory(a, b, volume, resolution)) return std::move(*best);
  }
}

/// What is wrong with a seam, in units of SeamScore::total(): edges of more than two faces and pieces more
/// than the models', borders that face none and crossing faces at the price that unfaced borders have there.
double flaws_of(const Assembly& t, const cut::Model& a, const cut::Model& b, double scale) {
  constexpr double kNonManifold = 1e6;  // an edge of more than two faces: no seam is worth it
  constexpr double kPiece = 10;
  const double per_length = cut::SeamScore::kReach / cut::SeamScore::kLambda / scale;
  const mesh::MeshCheck made = mesh::check(t.result.composed), of_a = mesh::check(a.prepared.mesh),
                        of_b = mesh::check(b.prepared.mesh);
  return kNonManifold * std::max(0, made.nonmanifold_edges - of_a.nonmanifold_edges - of_b.nonmanifold_edges) +
         kPiece * std::max(0, made.components - std::max(of_a.components, of_b.components)) + per_length * t.flaws;
}

/// The mesh cut; where its seam has flaws, the thesis' cut if seam and flaws together are better. A seam
/// without a flaw may be up to twice as bad otherwise: flaws are what other programs stumble over.
Assembly by_the_better_cut(cut::Model& a, cut::Model& b, const Box& volume, const ComposeOptions& options,
                           Progress& progress) {
  const double scale = std::min(cut::rms_size(a.prepared.mesh), cut::rms_size(b.prepared.mesh));
  Assembly first = by_mesh_cut(a, b, volume, options, progress);
  const bool marked = std::count(a.drop.begin(), a.drop.end(), 1) + std::count(b.drop.begin(), b.drop.end(), 1) > 0;
  if (flaws_of(first, a, b, scale) == 0 || !options.stitch || marked) return first;
  const auto badness = [&](const Assembly& t) {
    constexpr double kFlawed = 2;
    const double seam = cut::score_seam(cut::borders_of(a.prepared.mesh, t.result.clipped_a),
                                        cut::borders_of(b.prepared.mesh, t.result.clipped_b), scale)
                            .total();
    const double of_t = flaws_of(t, a, b, scale);
    return of_t == 0 ? seam : kFlawed * seam + of_t;
  };
  try {
    Assembly second = by_voxel_cut(a, b, volume, options, progress);
    if (badness(second) < badness(first)) {
      second.result.report.cut = cut::Cut::Thesis;
      return second;
    }
  } catch (const UserError&) {  // its voxels are too coarse, or too many
  }
  return first;
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

/// Whether the models look opposite ways: closed ones by what they enclose, open
/// ones by their normals where they run along each other.
bool look_apart(const cut::Model& a, const cut::Model& b) {
  constexpr int kSamples = 20000;
  const double volumes = enclosed(a.prepared) * enclosed(b.prepared);
  if (volumes != 0) return volumes < 0;
  const Mesh &of_a = a.prepared.mesh, &of_b = b.prepared.mesh;
  const double reach = 0.1 * std::min(cut::rms_size(of_a), cut::rms_size(of_b));
  const spatial::FaceTree tree(of_b);
  double balance = 0, weights = 0;
  for (int f = 0; f < of_a.face_count(); f += 1 + of_a.face_count() / kSamples) {
    const spatial::FaceTree::Hit hit = tree.nearest(of_a.center(f), reach);
    if (hit.face < 0) continue;
    const double weight = of_a.area(f) * (1 - hit.distance / reach);
    weights += weight, balance += weight * of_a.normal(f).dot(of_b.normal(hit.face));
  }
  return balance < -0.2 * weights;
}

}  // namespace

ComposeResult compose(const cut::Part& part_a, const cut::Part& part_b, const ComposeOptions& options,
                      Progress& progress) {
  const Clock clock;
  check(options);
  if (options.cut == cut::Cut::Thesis && (!part_a.drop.empty() || !part_b.drop.empty()))
    throw UserError("The cut Thesis knows no parts that must go; choose the cut Mesh, or mark none.");
  progress.stage("Preparing the models", 0, 10);
  cut::Model a = cut::make_model(part_a, part_a.name.empty() ? "model A" : part_a.name),
             b = cut::make_model(part_b, part_b.name.empty() ? "model B" : part_b.name);
  log_notes(a, "_A", progress), log_notes(b, "_B", progress);
  const Box volume = cut::transition_volume(a, b, options.volume);
  const bool turned = look_apart(a, b);
  if (turned) mesh::flip_orientation(b.prepared.mesh);

  ComposeResult result = options.cut == cut::Cut::Thesis
                             ? std::move(by_voxel_cut(a, b, volume, options, progress).result)
                             : std::move(by_the_better_cut(a, b, volume, options, progress).result);
  progress.stage("Finishing", 95, 100);
  if (options.cut == cut::Cut::Thesis) result.report.cut = options.cut;
  result.report.reversed_b = result.report.reversed_b != turned;
  result.report.seconds = clock.seconds();
  progress.at(1.0);
  return result;
}

}  // namespace parts::compose
