// SPDX-License-Identifier: GPL-3.0-or-later
// The filters of 3.3.1 and 3.3.2 of the thesis: surfaces restored and holes
// filled from a database of models. Names, help, parameters, one call into the
// core, new layers.
#include <chrono>

#include "parameters.h"
#include "parts/base/error.h"
#include "parts/host/common.h"
#include "parts/mend/mend.h"

namespace parts {

namespace {

using host::composition_reference;
using host::Inputs;
using host::Layer;
using host::log_value;
using host::Outcome;
using host::smoothing_of;
using host::surface_of;

/// What the three filters have in common.
mend::MendOptions query_options(const Inputs& inputs) {
  mend::MendOptions o;
  o.region.by = mend::RegionBy(inputs.choice("Region"));
  // A box made from its corners as they are: one that is inside out is told so.
  o.region.box.min() = inputs.point("RegionMin"), o.region.box.max() = inputs.point("RegionMax");
  o.region.margin = inputs.length("Margin");
  o.region.longest_rim = inputs.length("LongestRim");
  o.region.leave_selected = inputs.flag("LeaveSelected");
  o.search.candidates = inputs.integer("Candidates");
  o.search.levels = inputs.integer("Levels");
  o.search.allow_scale = inputs.flag("AllowScale");
  o.search.any_rotation = inputs.flag("AnyRotation");
  return o;
}

io::ModelDatabase database_of(const Inputs& inputs, Progress& progress) {
  const std::string path = inputs.text("Database");
  if (path.empty())
    throw UserError("No model database is given; choose a MeshLab project (.mlp), or type the path of a folder.");
  return io::ModelDatabase(path, progress);
}

Outcome find(const Inputs& inputs, Progress& progress) {
  const Layer layer = inputs.layer("Mesh");
  const Mesh scan = surface_of(layer);
  mend::MendOptions options = query_options(inputs);
  options.fill = options.region.by == mend::RegionBy::Holes;
  const io::ModelDatabase database = database_of(inputs, progress);
  std::vector<mend::Found> found = mend::find_models(scan, database, options, progress);
  Outcome outcome;
  const bool several = !found.empty() && found.back().region > 0;
  for (mend::Found& f : found) {
    const std::string where = several ? "Region " + std::to_string(f.region + 1) + ": " : "";
    outcome.layers.push_back({where + f.name, std::move(f.mesh), outcome.layers.empty()});
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
  o.refine = inputs.flag("Refine");
  o.allow_scale = inputs.flag("AllowScale");
  o.resolution = inputs.integer("Resolution");
  o.cut = cut_of(inputs);
  o.smoothing = smoothing_of(inputs);
  o.fit_to_rim = inputs.flag("FitToRim");
  o.blend = inputs.integer("Blend");
  const bool add_candidate = inputs.flag("AddCandidate");
  const io::ModelDatabase database = database_of(inputs, progress);

  mend::Mended mended = mend::mend_scan(scan, database, options, progress);
  log_value(progress, "regions", mended.regions);
  log_value(progress, "mended", mended.mended);
  log_value(progress, "faces", mended.mesh.face_count());
  log_value(progress, "seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());

  Outcome outcome;
  outcome.layers.push_back({fill ? "Filled" : "Restored", std::move(mended.mesh)});
  outcome.current = 0;
  if (add_candidate)
    for (mend::Found& f : mended.candidates)
      outcome.layers.push_back({"Candidate " + f.name, std::move(f.mesh), false});
  outcome.hidden = {layer};
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
           composition_reference,
       find_parameters, find},
      {"Database: Restore Surface", "restore", Menu::Remeshing,
       std::string("Replaces scars, dents and broken parts by surfaces of complete models of the same kind. Select "
                   "the damaged faces, or give a box around them. The most similar surface of the database is found "
                   "by what is still good around the flaw, fitted to it, and put in its place along the cut where "
                   "both are closest. Faces outside the region stay as they are.") +
           composition_reference,
       restore_parameters, restore},
      {"Database: Fill Hole", "fill_hole", Menu::Remeshing,
       std::string("Fills holes with surfaces of complete models of the same kind: a face gets a nose, not a lid. All "
                   "holes are filled, each from its own best match, or those beside the selected faces or in a box. "
                   "The scan stays as it is, to the rim.") +
           composition_reference,
       fill_parameters, fill},
  };
}

}  // namespace parts
