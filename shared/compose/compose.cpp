// SPDX-License-Identifier: GPL-3.0-or-later
#include "compose/compose.h"

#include <chrono>

#include "compose/clip.h"
#include "compose/crossings.h"
#include "compose/loops.h"
#include "compose/seam.h"
#include "compose/stitch.h"
#include "compose/transition.h"
#include "compose/transition_surface.h"
#include "compose/volume.h"
#include "geometry/attributes.h"
#include "voxel/rasterize.h"

namespace parts {
namespace {

class Clock {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The joint voxels, their labels, and how far apart the models may be.
struct Decision {
  JointVoxels voxels;
  VoxelLabels labels;
  int reach = 0;
};

/// Finds the cut at one resolution.
Decision decide(Model& a, Model& b, const Box& volume, int resolution, const ComposeOptions& options,
                ComposeReport& report) {
  Decision d;
  d.voxels = joint_voxels(a, b, volume, resolution, options.threads);
  report.voxels_a = report.voxels_b = report.voxels_both = 0;
  for (int n = 0; n < int(d.voxels.size()); ++n) {
    const std::uint8_t flags = d.voxels.flags[n];
    if ((flags & kKeepA) && (flags & kKeepB))
      throw UserError("What is to be kept of model A and of model B lies in the same voxel; mark parts farther apart, or raise the Resolution.");
    report.voxels_a += (flags & kHasA) != 0, report.voxels_b += (flags & kHasB) != 0;
    report.voxels_both += d.voxels.both(n);
  }
  report.grid = d.voxels.grid.dims;
  report.voxel_size = d.voxels.grid.size;
  const Clock clock;
  if (options.cut == Cut::Thesis) {
    d.labels = thesis_cut(d.voxels);
  } else {
    const auto normal_a = voxel_normals(a.prepared.mesh, d.voxels), normal_b = voxel_normals(b.prepared.mesh, d.voxels);
    d.reach = natural_reach(d.voxels, normal_a, normal_b);
    d.labels = refined_cut(d.voxels, normal_a, normal_b, {d.reach});
  }
  report.cut_seconds = clock.seconds();
  report.cut_cost = d.labels.cost;
  return d;
}

/// At the user's resolution, or at the natural one: coarser while the models do
/// not meet, finer while their constraints share a voxel.
Decision decide(Model& a, Model& b, const Box& volume, const ComposeOptions& options, ComposeReport& report,
                Progress& progress) {
  const char* apart =
      "The models do not touch between what is to be kept of A and of B; move them closer until they overlap, or choose a lower Resolution.";
  if (options.resolution < 0) throw UserError("The Resolution is negative; give a number of voxels, or 0 for automatic.");
  if (options.resolution > 0) {
    Decision d = decide(a, b, volume, options.resolution, options, report);
    if (!d.labels.connected) throw UserError(apart);
    return d;
  }
  int resolution = natural_resolution(a, b, volume);
  for (int finer = 0;; ++finer) try {
      while (true) {
        progress.at(0.3);
        Decision d = decide(a, b, volume, resolution, options, report);
        if (d.labels.connected) return d;
        if (finer || resolution <= 24) throw UserError(apart);
        resolution = std::max(24, resolution * 2 / 3);
      }
    } catch (const UserError& e) {
      if (finer == 2 || std::string(e.what()).find("same voxel") == std::string::npos) throw;
      resolution *= 2;
    }
}

Transition make_transition(const Model& a, const Model& b, const Decision& d, Cut cut) {
  if (cut == Cut::Thesis) return Transition::along_voxels(d.voxels, d.labels);
  return Transition::smooth(d.voxels, d.labels,
                            crossing_points(a.prepared.mesh, b.prepared.mesh, d.voxels, d.labels));
}

Clipped clip_model(const Model& model, bool of_a, const Decision& d, const Transition& transition, Cut cut, int threads) {
  const Mesh& mesh = model.prepared.mesh;
  const Grid& grid = d.voxels.grid;
  std::vector<signed char> pinned(mesh.faces.size(), 0);
  for (std::size_t f = 0; f < pinned.size(); ++f)
    if (model.keep[f])
      pinned[f] = 1;
    else if (const int piece = model.piece[f]; piece >= 0)
      pinned[f] = (d.labels.outer[piece] == VoxelLabels::kA) == of_a ? 1 : -1;
  ClipField field;
  const double sign = of_a ? 1 : -1;
  field.value = [&transition, sign, of_a](const Vec3& p) { return sign * transition.value(p, of_a); };
  field.crosses = [&transition, &grid](const Mesh& m, int f) {
    bool near = false;
    for_each_voxel(grid, m, f, [&](std::size_t v) { near |= transition.near(v); });
    return near;
  };
  field.max_edge = grid.size * (cut == Cut::Thesis ? 0.5 : 1.0);
  return clip(mesh, pinned, field, threads);
}

/// The two clipped models in one mesh, with what is known of its elements.
struct Joined {
  Mesh mesh;
  std::vector<char> tag;    ///< per face: 0 from A, 1 from B, 2 from the stitch
  std::vector<char> seam;   ///< per vertex: made by the cut
  std::vector<char> fixed;  ///< per vertex: of a kept face
  std::vector<int> like;    ///< per vertex: a face at it
  std::vector<char> closed; ///< per vertex: its input component had no boundary
  std::vector<Loop> loops_a, loops_b;
};

Joined join_parts(const Model& a, const Clipped& ca, const Model& b, const Clipped& cb) {
  Joined j;
  j.mesh = ca.mesh;
  append(j.mesh, cb.mesh);
  const int first_b = ca.mesh.vertex_count();
  j.seam = ca.cut_vertex;
  j.seam.insert(j.seam.end(), cb.cut_vertex.begin(), cb.cut_vertex.end());
  j.fixed.assign(j.mesh.vertices.size(), 0), j.closed = j.fixed;
  j.like.assign(j.mesh.vertices.size(), -1);
  for (int f = 0; f < j.mesh.face_count(); ++f) {
    const bool from_b = f >= ca.mesh.face_count();
    const Model& model = from_b ? b : a;
    const int source = from_b ? cb.source_face[f - ca.mesh.face_count()] : ca.source_face[f];
    j.tag.push_back(from_b);
    for (int v : j.mesh.faces[f]) {
      j.like[v] = f;
      j.fixed[v] |= model.keep[source];
      j.closed[v] = model.prepared.closed[model.prepared.component[source]];
    }
  }
  j.loops_a = trace_loops(ca.border);
  std::vector<std::array<int, 2>> border_b = cb.border;
  for (auto& e : border_b) e[0] += first_b, e[1] += first_b;
  j.loops_b = trace_loops(border_b);
  return j;
}

/// Turns B's part over if most of the seam says that it faces the other way.
void agree_on_orientation(Joined& j, std::vector<std::array<int, 2>>& pairs, Progress& progress) {
  double balance = 0;
  for (const auto& [i, k] : pairs)
    balance += loop_length(j.mesh, j.loops_a[i]) * (same_direction(j.mesh, j.loops_a[i], j.loops_b[k]) ? 1 : -1);
  if (balance > 0) {
    for (int f = 0; f < j.mesh.face_count(); ++f)
      if (j.tag[f] == 1) {
        std::swap(j.mesh.faces[f][1], j.mesh.faces[f][2]);
        if (!j.mesh.wedges.empty()) std::swap(j.mesh.wedges[f].uv[1], j.mesh.wedges[f].uv[2]);
      }
    for (Loop& l : j.loops_b) std::reverse(l.vertices.begin(), l.vertices.end());
    progress.log("reversed: model B's faces, to agree with model A's");
  }
  // What still runs the wrong way would make a twisted strip.
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(),
                             [&](const auto& p) { return same_direction(j.mesh, j.loops_a[p[0]], j.loops_b[p[1]]); }),
              pairs.end());
}

void stitch(Joined& j, double max_gap, ComposeReport& report, Progress& progress) {
  std::vector<std::array<int, 2>> pairs = match_loops(j.mesh, j.loops_a, j.loops_b, max_gap, report.seam_gap);
  agree_on_orientation(j, pairs, progress);
  std::vector<char> joined_a(j.loops_a.size(), 0), joined_b(j.loops_b.size(), 0);
  for (const auto& [i, k] : pairs) {
    joined_a[i] = joined_b[k] = 1;
    report.seam_length += loop_length(j.mesh, j.loops_a[i]);
    zipper(j.mesh, j.loops_a[i], j.loops_b[k], j.like);
  }
  report.loops_joined = int(pairs.size());
  // A contour with none opposite: a closed model stays closed.
  const auto finish = [&](const std::vector<Loop>& loops, const std::vector<char>& joined) {
    for (std::size_t i = 0; i < loops.size(); ++i) {
      if (joined[i]) continue;
      if (loops[i].closed && j.closed[loops[i].vertices[0]])
        cap(j.mesh, loops[i], j.like), ++report.loops_capped;
      else
        ++report.loops_open;
    }
  };
  finish(j.loops_a, joined_a), finish(j.loops_b, joined_b);
  j.tag.resize(j.mesh.faces.size(), 2);
}

void finish_seam(Joined& j, double voxel, const SeamSmoothing& smoothing) {
  tidy_seam(j.mesh, j.seam, j.fixed, j.tag, 0.3 * voxel);
  const std::vector<Vec3> before = j.mesh.vertices;
  smooth_seam(j.mesh, j.seam, j.fixed, smoothing.distance > 0 ? smoothing.distance : 2 * voxel, smoothing.iterations,
              smoothing.weight);
  if (j.mesh.vertex_normal.empty()) return;
  // Normals are the inputs' own but around the seam.
  std::vector<Eigen::Vector3f> normals = j.mesh.vertex_normal;
  update_normals(j.mesh);
  std::vector<char> changed = j.seam;
  for (const Triangle& f : j.mesh.faces) {
    bool any = false;
    for (int v : f) any |= j.seam[v] || before[v] != j.mesh.vertices[v];
    if (any)
      for (int v : f) changed[v] = 1;
  }
  for (std::size_t v = 0; v < normals.size(); ++v)
    if (!changed[v]) j.mesh.vertex_normal[v] = normals[v];
}

void check(const ComposeOptions& o) {
  if (o.smoothing.iterations < 0) throw UserError("SmoothIterations is negative; give 0 for no smoothing, or more.");
  if (!(o.smoothing.weight >= 0 && o.smoothing.weight <= 1))
    throw UserError("SmoothWeight must lie between 0 (vertices stay) and 1 (vertices go to their neighbours' mean).");
  if (!(o.smoothing.distance >= 0) || !std::isfinite(o.smoothing.distance))
    throw UserError("SmoothDistance must be a length of 0 or more; 0 means two voxels.");
}

void log_notes(const Model& m, Progress& progress) {
  const auto say = [&](const char* what, int count) {
    if (count) progress.log(std::string(what) + "_" + m.name + ": " + std::to_string(count));
  };
  say("welded_vertices", m.prepared.welded_vertices);
  say("dropped_faces", m.prepared.dropped_faces);
  say("reversed_faces", m.prepared.reversed_faces);
}

}  // namespace

ComposeResult compose(const Part& part_a, const Part& part_b, const ComposeOptions& options, Progress& progress) {
  const Clock clock;
  check(options);
  ComposeResult result;
  ComposeReport& report = result.report;
  progress.stage("Preparing the models", 0, 10);
  Model a = make_model(part_a, "A"), b = make_model(part_b, "B");
  log_notes(a, progress), log_notes(b, progress);
  const Box volume = transition_volume(a, b, options.volume);

  progress.stage("Finding the minimal cut", 10, 50);
  const Decision decision = decide(a, b, volume, options, report, progress);
  const Transition transition = make_transition(a, b, decision, options.cut);

  progress.stage("Clipping", 50, 75);
  const Clipped ca = clip_model(a, true, decision, transition, options.cut, options.threads);
  progress.at(0.5);
  const Clipped cb = clip_model(b, false, decision, transition, options.cut, options.threads);
  result.clipped_a = ca.mesh, result.clipped_b = cb.mesh;

  progress.stage("Stitching", 75, 95);
  Joined joined = join_parts(a, ca, b, cb);
  report.loops_a = int(joined.loops_a.size()), report.loops_b = int(joined.loops_b.size());
  if (options.stitch) {
    stitch(joined, (3 + 2 * decision.reach) * report.voxel_size, report, progress);
    progress.stage("Smoothing the seam", 95, 99);
    finish_seam(joined, report.voxel_size, options.smoothing);
  }
  if (options.transition_surface) result.transition = transition_surface(decision.voxels, decision.labels, transition);
  result.composed = std::move(joined.mesh);
  result.face_from_b = std::move(joined.tag);
  report.seconds = clock.seconds();
  progress.at(1.0);
  return result;
}

}  // namespace parts
