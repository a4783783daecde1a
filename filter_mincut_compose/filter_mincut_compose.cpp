// SPDX-License-Identifier: GPL-3.0-or-later
// The filters of chapter 3.2 of the thesis: placing, composing and bending
// models. Names, help, parameters, one call into the core, new layers.
#include <cmath>
#include <sstream>

#include "parameters.h"
#include "parts/align/align.h"
#include "parts/base/error.h"
#include "parts/compose/compose.h"
#include "parts/compose/constraint.h"
#include "parts/compose/deform.h"
#include "parts/cut/seam_score.h"
#include "parts/host/common.h"

namespace parts {

namespace {

using host::cut_of;
using host::Inputs;
using host::Layer;
using host::log_value;
using host::Outcome;
using host::smoothing_of;
using host::surface_of;

/// A value of ConstraintBy, then two points of a box.
std::vector<char> kept_faces(const Inputs& inputs, const std::string& parameter, const Mesh& mesh, const char* model) {
  return compose::constrained_faces(mesh, compose::ConstraintBy(inputs.choice(parameter.c_str())),
                                    inputs.point((parameter + "Min").c_str()),
                                    inputs.point((parameter + "Max").c_str()), model);
}

/// None, or a value of ConstraintBy but for the selected faces, then two points of a box.
std::vector<char> dropped_faces(const Inputs& inputs, const std::string& parameter, const Mesh& mesh,
                                const char* model) {
  const int by = inputs.choice(parameter.c_str());
  if (by == 0) return {};
  return compose::constrained_faces(mesh, compose::ConstraintBy(by), inputs.point((parameter + "Min").c_str()),
                                    inputs.point((parameter + "Max").c_str()), model, compose::Mark::Drop);
}

/// The options that Compose and Deform have in common.
compose::ComposeOptions cut_options(const Inputs& inputs) {
  compose::ComposeOptions options;
  options.resolution = inputs.integer("Resolution");
  options.cut = cut_of(inputs);
  options.smoothing = smoothing_of(inputs);
  options.smoothing.blend_distance = inputs.length("BlendDistance");
  // The published cut is smoothed as published, unless it is asked for more.
  options.smoothing.blend = options.cut != cut::Cut::Thesis || options.smoothing.blend_distance > 0;
  return options;
}

Box volume_of(const Inputs& inputs) {
  if (inputs.choice("Volume") == 0) return Box();
  const Vec3 min = inputs.point("VolumeMin"), max = inputs.point("VolumeMax");
  if (!((max - min).minCoeff() > 0))
    throw UserError("The transition volume has no thickness; give a VolumeMax above VolumeMin in x, y and z.");
  return Box(min, max);
}

void log_report(const compose::ComposeReport& r, const Mesh& composed, Progress& progress) {
  log_value(progress, "cut", r.cut == cut::Cut::Thesis ? "Thesis" : "Mesh");
  if (r.cut == cut::Cut::Thesis) {
    std::ostringstream grid;
    grid << r.grid[0] << " " << r.grid[1] << " " << r.grid[2];
    log_value(progress, "grid", grid.str());
    log_value(progress, "voxel_size", r.voxel_size);
    log_value(progress, "voxels_a", r.voxels_a);
    log_value(progress, "voxels_b", r.voxels_b);
    log_value(progress, "voxels_both", r.voxels_both);
  } else {
    log_value(progress, "scale", r.scale);
    log_value(progress, "reach", r.reach);
    log_value(progress, "crossing_segments", r.crossing_segments);
    log_value(progress, "broken_ties", r.broken_ties);
  }
  log_value(progress, "cut_cost", r.cut_cost);
  log_value(progress, "cut_seconds", r.cut_seconds);
  log_value(progress, "seam_length", r.seam_length);
  log_value(progress, "seam_gap", r.seam_gap);
  log_value(progress, "loops_a", r.loops_a);
  log_value(progress, "loops_b", r.loops_b);
  log_value(progress, "loops_joined", r.loops_joined);
  log_value(progress, "pieces_joined", r.pieces_joined);
  log_value(progress, "loops_capped", r.loops_capped);
  log_value(progress, "loops_open", r.loops_open);
  log_value(progress, "pieces_dropped", r.pieces_dropped);
  log_value(progress, "blend_distance", r.blend.distance);
  log_value(progress, "seam_angle_before", r.blend.angle_before);
  log_value(progress, "seam_angle_after", r.blend.angle_after);
  log_value(progress, "reversed_b", r.reversed_b);
  log_value(progress, "faces", composed.face_count());
  log_value(progress, "seconds", r.seconds);
}

/// The objective J of the seam and its parts.
void log_seam(const cut::SeamScore& s, Progress& progress) {
  const double unit = cut::SeamScore::kLambda * s.scale * s.scale;
  log_value(progress, "objective", s.total());
  log_value(progress, "objective_gap", s.gap / unit);
  log_value(progress, "objective_length", s.length / unit);
  log_value(progress, "objective_turn", s.turn / unit);
  log_value(progress, "objective_unfaced", s.unfaced / unit);
}

Outcome align_layer(const Inputs& inputs, Progress& progress) {
  const Layer moving = inputs.layer("MovingMesh"), fixed = inputs.layer("FixedMesh");
  if (moving == fixed) throw UserError("MovingMesh and FixedMesh are the same layer; choose two different layers.");
  align::AlignOptions options;
  options.coarse = inputs.choice("Coarse") == 0;
  options.allow_scale = inputs.flag("AllowScale");
  options.allow_mirror = inputs.flag("AllowMirror");
  options.max_iterations = inputs.integer("MaxIterations");
  // MeshLab's numbers are single precision. At the default nobody has said how much matches.
  options.less_overlap = std::abs(inputs.number("Overlap") - options.overlap) < 1e-6;
  options.overlap = inputs.number("Overlap");
  const bool to_vertices = inputs.choice("ApplyTo") == 1, selected = inputs.flag("OnlySelected");

  const Mesh a = surface_of(moving), b = surface_of(fixed);
  const std::vector<char> all;
  const align::AlignResult result = align::align_part_in_whole(a, selected ? a.face_selected : all, b,
                                                               selected ? b.face_selected : all, options, progress);
  std::ostringstream matrix;
  matrix.precision(9);
  for (int i = 0; i < 16; ++i) matrix << (i ? " " : "") << result.matrix(i / 4, i % 4);
  log_value(progress, "matrix", matrix.str());
  log_value(progress, "rms_before", result.rms_before);
  log_value(progress, "rms_after", result.rms_after);
  log_value(progress, "inlier_share", result.inlier_share);
  log_value(progress, "iterations", result.iterations);
  log_value(progress, "candidates", result.candidates);
  log_value(progress, "overlap", result.overlap);
  for (const std::string& doubt : result.doubts) log_value(progress, "warning", doubt);

  Outcome outcome;
  outcome.placed.push_back({moving, result.matrix, to_vertices});
  return outcome;
}

Outcome compose_layers(const Inputs& inputs, Progress& progress) {
  const Layer a = inputs.layer("MeshA"), b = inputs.layer("MeshB");
  if (a == b)
    throw UserError("MeshA and MeshB are the same layer; choose two different layers, or duplicate this one.");
  compose::ComposeOptions options = cut_options(inputs);
  options.volume = volume_of(inputs);
  options.stitch = inputs.flag("Stitch");
  options.transition_surface = inputs.flag("AddTransitionSurface");
  const bool clipped = inputs.flag("AddClippedLayers");

  cut::Part part_a{surface_of(a), {}}, part_b{surface_of(b), {}};
  part_a.keep = kept_faces(inputs, "KeepA", part_a.mesh, "model A");
  part_b.keep = kept_faces(inputs, "KeepB", part_b.mesh, "model B");
  part_a.drop = dropped_faces(inputs, "DropA", part_a.mesh, "model A");
  part_b.drop = dropped_faces(inputs, "DropB", part_b.mesh, "model B");
  compose::ComposeResult result = compose::compose(part_a, part_b, options, progress);
  log_report(result.report, result.composed, progress);
  log_seam(
      cut::score_seam(cut::borders_of(part_a.mesh, result.clipped_a), cut::borders_of(part_b.mesh, result.clipped_b),
                      std::min(cut::rms_size(part_a.mesh), cut::rms_size(part_b.mesh))),
      progress);
  if (options.stitch && result.report.loops_joined + result.report.pieces_joined == 0)
    log_value(progress, "warning",
              "Nothing was stitched, as no border of one model faces one of the other; move the models farther into "
              "each other, or mark parts that lie on both sides of the place where they meet.");

  Outcome outcome;
  mesh::ResultRules whole, open;
  whole.joins = true;
  open.may_part = open.may_open = true;
  Outcome::Check check{{a, b}, whole};
  if (!options.stitch) check.rules = open, check.part = result.face_from_b;  // a hat on a head
  outcome.layers.push_back({"Composed", std::move(result.composed), true, {}, std::move(check)});
  outcome.current = 0;
  if (clipped) outcome.layers.push_back({"Clipped A", std::move(result.clipped_a), false, {}, {{a}, open}});
  if (clipped) outcome.layers.push_back({"Clipped B", std::move(result.clipped_b), false, {}, {{b}, open}});
  if (options.transition_surface)
    outcome.layers.push_back({"Transition surface", std::move(result.transition), false, {}, {{}, open}});
  outcome.hidden = {a, b};
  return outcome;
}

Outcome deform_layer(const Inputs& inputs, Progress& progress) {
  const Layer layer = inputs.layer("Mesh");
  const compose::ComposeOptions options = cut_options(inputs);
  compose::RigidPose pose;
  pose.pivot = inputs.point("Pivot");
  pose.axis = inputs.point("Axis");
  pose.angle = inputs.number("Angle");
  pose.translation = inputs.point("Translation");
  pose.scale = inputs.number("Scale");
  pose.mirror = inputs.flag("Mirror");
  const int frames = inputs.integer("Frames");

  const Mesh mesh = surface_of(layer);
  const std::vector<char> fixed = kept_faces(inputs, "Fixed", mesh, "the fixed part");
  const std::vector<char> moving = kept_faces(inputs, "Moving", mesh, "the moving part");
  std::vector<compose::ComposeResult> results = compose::deform(mesh, fixed, moving, pose, frames, options, progress);

  Outcome outcome;
  const std::string count = std::to_string(results.size());
  for (size_t i = 0; i < results.size(); ++i) {
    if (results.size() > 1) log_value(progress, "frame", std::to_string(i + 1) + "/" + count);
    log_report(results[i].report, results[i].composed, progress);
    constexpr double kTorn = 0.5;  // of the model's size: no joint opens as far
    if (results[i].report.scale > 0 && results[i].report.seam_gap > kTorn * results[i].report.scale)
      log_value(
          progress, "warning",
          "The pose moves the parts so far from each other that the surface between them is drawn out; look at it "
          "before you use it, or give a pivot in the joint.");
    const std::string name = results.size() > 1 ? "Deformed " + std::to_string(i + 1) + " of " + count : "Deformed";
    mesh::ResultRules rules;
    rules.moved = true;
    outcome.layers.push_back({name, std::move(results[i].composed), i + 1 == results.size(), {}, {{layer}, rules}});
  }
  outcome.current = int(results.size()) - 1;
  outcome.hidden = {layer};
  return outcome;
}

}  // namespace

std::vector<host::Filter> host::filters() {
  return {
      {"Min-Cut: Align Part in Whole", "align_part_in_whole", Menu::Placement,
       std::string("Places a model so that a part of it lies on the matching part of another: a human torso on a "
                   "horse's neck, one head on another. Select the two matching parts (for instance with the face "
                   "brush), one on each layer, or compare the models as wholes. The <b>moving</b> layer is brought "
                   "onto the <b>fixed</b> one by a rigid motion, with a change of size or a reflection where you "
                   "allow it: principal axes give first guesses, iterated closest points refine each, and the best "
                   "match wins.") +
           host::composition_reference,
       align_parameters, align_layer, false},
      {"Min-Cut: Compose Two Meshes", "compose", Menu::Remeshing,
       std::string("Joins two overlapping models into one, without a visible seam. Place the models so that they "
                   "overlap where they should be joined, and mark on each some faces that <b>must survive</b>. The "
                   "filter finds where the two surfaces are closest (a minimal cut through their voxels), drops what "
                   "lies on the wrong side, stitches the borders and smooths the seam. Faces away from the seam, their "
                   "colours and their textures stay as they are. The marks belong to the surface: move a layer and "
                   "run again without marking anew.") +
           host::composition_reference,
       compose_parameters, compose_layers},
      {"Min-Cut: Deform by Rigid Parts", "deform", Menu::Deformation,
       std::string("Bends a model where it has joints: arms, necks, tails. Mark some faces that stay where they are "
                   "and some that move (the upper arm and the hand); the moving ones are turned, shifted, scaled or "
                   "mirrored about a pivot (the elbow), and a minimal cut finds where the moved model continues the "
                   "unmoved one. Several frames make an animation, one layer each.") +
           host::composition_reference,
       deform_parameters, deform_layer},
  };
}

}  // namespace parts
