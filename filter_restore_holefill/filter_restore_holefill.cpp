// SPDX-License-Identifier: GPL-3.0-or-later
// The filters of 3.3.1 and 3.3.2 of the thesis: surfaces restored and holes
// filled from a database of models; and a model of it as a layer. Names, help, parameters, one call into the
// core, new layers.
#include <chrono>
#include <filesystem>
#include <optional>

#include "parameters.h"
#include "parts/base/error.h"
#include "parts/host/common.h"
#include "parts/io/mesh_io.h"
#include "parts/mend/mend.h"

namespace parts {

namespace {

using host::Inputs;
using host::Layer;
using host::log_value;
using host::Outcome;
using host::smoothing_of;
using host::surface_of;

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

/// A model of the database, as found.
const Outcome::Check as_it_is{{}, {}, true};

/// What the three filters have in common.
mend::MendOptions query_options(const Inputs& inputs) {
  mend::MendOptions o;
  o.region.by = mend::RegionBy(inputs.choice("Region"));
  // A box made from its corners as they are: one that is inside out is told so.
  o.region.box.min() = inputs.point("RegionMin"), o.region.box.max() = inputs.point("RegionMax");
  o.region.margin = inputs.length("Margin");
  o.region.longest_rim = inputs.length("LongestRim");
  o.region.largest_hole = inputs.integer("LargestHole");
  o.region.leave_selected = inputs.flag("LeaveSelected");
  o.search.candidates = inputs.integer("Candidates");
  o.search.levels = inputs.integer("Levels");
  o.search.allow_scale = inputs.flag("AllowScale");
  o.search.any_rotation = inputs.flag("AnyRotation");
  return o;
}

/// None where the scan itself is to be the database.
std::optional<io::ModelDatabase> database_of(const Inputs& inputs, Progress& progress) {
  const std::string path = inputs.text("Database");
  if (path.empty()) return {};
  return io::ModelDatabase(path, progress);
}

void log_candidate(int rank, const std::string& name, double score, Progress& progress) {
  progress.log("candidate_" + std::to_string(rank) + ": " + name + " " + number(score));
}

void log_found(const std::vector<mend::Found>& found, Progress& progress) {
  const int regions = found.empty() ? 0 : found.back().region + 1;
  int rank = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const mend::Found& f = found[i];
    if (i == 0 || f.region != found[i - 1].region) {
      progress.log("region: " + std::to_string(f.region + 1) + "/" + std::to_string(regions));
      rank = 0;
    }
    log_candidate(++rank, f.name, f.score, progress);
  }
}

void log_restored(const mend::RegionReport& region, Progress& progress) {
  const mend::RestoreReport& r = region.restored;
  progress.log("model: " + region.candidates[std::size_t(r.model)].name);
  const auto log = [&](const char* name, double value) { log_value(progress, name, value); };
  log("blended", r.blended);
  log("rms_before", r.rms_before), log("rms_after", r.rms_after), log("inlier_share", r.inlier_share);
  log("faces_replaced", r.faces_replaced), log("faces_added", r.faces_added);
  log("rims_joined", r.rims_joined), log("borders_capped", r.borders_capped);
  log("islands_dropped", r.islands_dropped);
  log("seam_length", r.seam_length), log("seam_gap", r.seam_gap);
}

/// Each region, then what is as it was and why, and the whole in words.
void log_mended(const mend::Mended& mended, bool fill, Progress& progress) {
  using End = mend::RegionReport::End;
  const int small = mended.count(End::Small), searched = int(mended.regions.size()) - small;
  if (small) log_value(progress, "closed_small", small);
  int number_of = 0, left = 0;
  std::string reasons;
  for (const mend::RegionReport& region : mended.regions) {
    if (region.end == End::Small) continue;
    progress.log("region: " + std::to_string(++number_of) + "/" + std::to_string(searched));
    for (std::size_t i = 0; i < region.candidates.size(); ++i)
      log_candidate(int(i) + 1, region.candidates[i].name, region.candidates[i].score, progress);
    if (region.not_meant) log_value(progress, "selected_behind", region.not_meant);
    if (region.end == End::WithOthers) progress.log("mended_before: 1");
    if (region.end == End::Mended) log_restored(region, progress);
    if (region.end != End::Left) continue;
    progress.log("left_as_it_was: " + region.left_because);
    reasons += (left++ ? "; " : "") + std::to_string(number_of) + ": " +
               region.left_because.substr(0, region.left_because.find(';'));
  }
  progress.log("left_open: " + std::to_string(left) + (left ? " (" + reasons + ")" : ""));
  progress.log(mend::summary(mended, fill));
}

Outcome find(const Inputs& inputs, Progress& progress) {
  const Layer layer = inputs.layer("Mesh");
  const Mesh scan = surface_of(layer);
  mend::MendOptions options = query_options(inputs);
  options.fill = options.region.by == mend::RegionBy::Holes;  // with Selected or all: flaws where any are selected
  const std::optional<io::ModelDatabase> database = database_of(inputs, progress);
  std::vector<mend::Found> found = mend::find_models(scan, database ? &*database : nullptr, options, progress);
  log_found(found, progress);
  Outcome outcome;
  const bool several = !found.empty() && found.back().region > 0;
  for (mend::Found& f : found) {
    const std::string where = several ? "Region " + std::to_string(f.region + 1) + ": " : "";
    outcome.layers.push_back({where + f.name, std::move(f.mesh), outcome.layers.empty(), {}, as_it_is});
  }
  outcome.current = 0;
  return outcome;
}

Outcome mend(const Inputs& inputs, Progress& progress, bool fill) {
  const auto start = std::chrono::steady_clock::now();
  const Layer layer = inputs.layer("Mesh");
  const Mesh scan = surface_of(layer);
  mend::MendOptions options = query_options(inputs);
  options.fill = fill;
  mend::RestoreOptions& o = options.restore;
  o.constraint_distance = inputs.number("ConstraintDistance");
  o.fitting.refine = inputs.flag("Refine");
  o.fitting.allow_scale = inputs.flag("AllowScale");
  o.resolution = inputs.integer("Resolution");
  o.cut = cut_of(inputs);
  o.smoothing = smoothing_of(inputs);
  o.fitting.fit_to_rim = inputs.flag("FitToRim");
  o.fitting.blend = inputs.integer("Blend");
  o.match_color = inputs.flag("MatchColour");
  const bool add_candidate = inputs.flag("AddCandidate");
  const std::optional<io::ModelDatabase> database = database_of(inputs, progress);

  mend::Mended mended = mend::mend_scan(scan, database ? &*database : nullptr, options, progress);
  log_mended(mended, fill, progress);
  log_value(progress, "regions", double(mended.regions.size()));
  log_value(progress, "mended", double(mended.regions.size()) - mended.count(mend::RegionReport::End::Left));
  log_value(progress, "faces", mended.mesh.face_count());
  log_value(progress, "seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());

  Outcome outcome;
  outcome.layers.push_back({fill ? "Filled" : "Restored", std::move(mended.mesh), true, {}, {{layer}}});
  outcome.current = 0;
  if (add_candidate)
    for (mend::Found& f : mended.candidates)
      outcome.layers.push_back({"Candidate " + f.name, std::move(f.mesh), false, {}, as_it_is});
  outcome.hidden = {layer};
  return outcome;
}

Outcome open(const Inputs& inputs, Progress& progress) {
  const std::string file = inputs.text("File");
  if (file.empty()) throw UserError("No model is given; choose a .ply, .obj, .off or .stl file.");
  std::vector<std::string> missing;
  Mesh mesh = io::read_mesh(
      file, [&] { progress.at(0); }, &missing);
  for (const std::string& name : missing)
    log_value(progress, "warning", "The model names \"" + name + "\", which is not there; put it beside the file.");
  log_value(progress, "vertices", mesh.vertex_count());
  log_value(progress, "faces", mesh.face_count());
  Outcome outcome;
  outcome.layers.push_back({std::filesystem::path(file).filename().string(), std::move(mesh), true, {}, as_it_is});
  outcome.current = 0;
  return outcome;
}

Outcome restore(const Inputs& inputs, Progress& progress) { return mend(inputs, progress, false); }
Outcome fill(const Inputs& inputs, Progress& progress) { return mend(inputs, progress, true); }

}  // namespace

std::vector<host::Filter> host::filters() {
  return {
      {"Database: Find Similar Surfaces", "find_similar", Menu::Remeshing,
       std::string("Searches a database of complete models for the surfaces most like the one around the selection, a "
                   "hole or a box, wherever and however large they are in their models, and adds the best ones as "
                   "layers, placed on the scan.") +
           host::composition_reference,
       find_parameters, find},
      {"Database: Restore Surface", "restore", Menu::Remeshing,
       std::string("Replaces scars, dents and broken parts by surfaces of complete models of the same kind. Select "
                   "the damaged faces, or give a box around them. The most similar surface of the database is found "
                   "by what is still good around the flaw, fitted to it, and put in its place along the cut where "
                   "both are closest. Faces outside the region stay as they are.") +
           host::composition_reference,
       restore_parameters, restore},
      {"Database: Fill Hole", "fill_hole", Menu::Remeshing,
       std::string("Fills holes with surfaces of complete models of the same kind: a face gets a nose, not a lid. The "
                   "holes beside the selected faces are filled, or all where none is selected, each from its own best "
                   "match; or those in a box. The scan stays as it is, to the rim; the new faces are selected.") +
           host::composition_reference,
       fill_parameters, fill},
      {"Database: Open Model as Layer", "open_model", Menu::Creation,
       "Opens a .ply, .obj, .off or .stl file as a layer, by the readers that the model databases are read with. For "
       "hosts whose own readers fail: MeshLab 2020.09 as Debian builds it ends at every .obj.",
       open_parameters, open, false},
  };
}

}  // namespace parts
