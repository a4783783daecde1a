// SPDX-License-Identifier: GPL-3.0-or-later
// Names and types are relied on by scripts outside the project: they do not change.
#include "parameters.h"

#include "parts/host/common.h"
#include "parts/mend/mend.h"

namespace parts {

namespace {

using namespace host;

Parameter allow_scale(bool value) {
  return flag("AllowScale", value, "Allow a change of size",
              "The models may grow or shrink, equally in all directions. Other units of length are found either way.");
}

/// What all three filters begin with.
std::vector<Parameter> query(const Scene& scene, mend::RegionBy by, int candidates, const std::string& candidates_are) {
  const search::SearchOptions search;
  std::vector<Parameter> list = {current_layer("Mesh", "Scan", "The damaged or incomplete model.")};
  list.push_back(open_file("Database", {"mlp", "ply", "obj", "off", "stl"}, "Model database",
                           "Complete models of the same kind: a MeshLab project (.mlp), or a folder of .ply, .obj, "
                           ".off and .stl files (in the dialog choose any file in it, in scripts the folder). What the "
                           "search computes is kept beside it for the next time. Left empty, the scan itself is the "
                           "database: the other half of what is symmetric, or another place that is alike."));
  list.push_back(choice("Region", int(by), {"Around the selection", "Around all holes", "Box", "Selected or all"},
                        "Where",
                        "Around the selection: the selected faces are the flaws, or lie beside the holes. Around all "
                        "holes: each open border by itself. Box: what the box below holds. Selected or all: the "
                        "selection where there is one, else all holes."));
  add_box("Region", "Where", scene.current, list);
  list.push_back(length("Margin", 0, "Good surface around it",
                        "How far the region reaches beyond the flaw or the hole, in the units of the scan; around a "
                        "box, how far beyond the box. 0 is a third of the flaw's or hole's half size (nothing around a "
                        "box)."));
  list.push_back(integer("Candidates", candidates, 1, 1000, "Candidates", candidates_are));
  list.push_back(integer("Levels", search.levels, 1, 3, "Levels of the search",
                         "The models are compared at so many resolutions, each twice as fine as the one before; at "
                         "each the worse half is dropped."));
  return list;
}

/// What all three filters end with.
void add_search(std::vector<Parameter>& list) {
  const search::SearchOptions search;
  const mend::RegionOptions region;
  list.push_back(flag("AnyRotation", search.any_rotation, "Models may lie any way",
                      "Tries every rotation of the models. Without it only rotations of up to about 30 degrees, which "
                      "is quicker and safer where scan and models share a frame."));
  list.push_back(length("LongestRim", region.longest_rim, "Longest rim",
                        "Of all holes, those with a border longer than this stay open, as a neck or a base is meant to "
                        "be. 0 fills all."));
  list.push_back(integer("LargestHole", region.largest_hole, 0, 100000000, "Largest hole (edges)",
                         "Of all holes, those with more edges at their border stay open. 0 fills all."));
  list.push_back(flag("LeaveSelected", region.leave_selected, "Leave holes with selected faces",
                      "With Around all holes: holes with a selected face at their rim stay open."));
}

std::vector<Parameter> mend_parameters(const Scene& scene, bool fill) {
  const mend::RestoreOptions o;
  std::vector<Parameter> list =
      query(scene, fill ? mend::RegionBy::SelectedOrAll : mend::RegionBy::Selection, mend::RestoreOptions().tries,
            "Of so many of the most similar models, the first that closes what is open, and cleanly, is the base.");
  list.push_back(number("ConstraintDistance", o.constraint_distance, 0.01, 0.99, "Constraint distance",
                        "How much is certain to stay, and to be replaced: a share of the region's half size (flaws), "
                        "or of the largest distance of the model from the scan (holes, with the cut of the "
                        "thesis; otherwise the rim of a hole is the border). The cut finds the rest; results hardly "
                        "depend on it."));
  list.push_back(flag("Refine", o.fitting.refine, "Refine the placement",
                      "Places the models once more by iterated closest points on the surface around the region."));
  list.push_back(allow_scale(o.fitting.allow_scale));
  list.push_back(integer("Resolution", o.resolution, 0, 100000, "Resolution (voxels)",
                         "Of the cut Thesis: voxels along the longest side of the region. 0 chooses from the meshes "
                         "and the free memory."));
  list.push_back(
      cut_choice("Mesh: the minimal cut on the faces of the scan; around a hole the whole scan is "
                 "kept. Thesis: the published cut through voxels, with the constraints that the distance "
                 "above gives."));
  add_smoothing("two edges of the rim (two voxels with the cut Thesis)", list);
  list.push_back(flag("AddCandidate", false, "Add the model that was used",
                      "Adds the model that each region was mended with, as it was placed and fitted, hidden."));
  list.push_back(flag("FitToRim", o.fitting.fit_to_rim, "Fit the model to the scan",
                      "Bends the model smoothly until it meets the surface around the flaw or hole, its details kept. "
                      "Without it the model is pasted as it is, as in the thesis."));
  list.push_back(
      integer("Blend", o.fitting.blend, 1, 1000, "Blend so many models",
              "Of so many of the most similar models, the likeliest mixture for the surface around the flaw or hole "
              "is taken. 1 takes the best alone, as in the thesis; quicker."));
  add_search(list);
  list.push_back(flag("MatchColour", o.match_color, "Match the scan's colours",
                      "Where the scan has vertex colours, the patch's go on from those at its rim. Without it the "
                      "patch has the model's."));
  return list;
}

}  // namespace

std::vector<Parameter> find_parameters(const Scene& scene) {
  const search::SearchOptions search;
  std::vector<Parameter> list =
      query(scene, mend::RegionBy::Selection, 3, "How many of the most similar models are taken, at most.");
  list.push_back(allow_scale(search.allow_scale));
  add_search(list);
  return list;
}

std::vector<Parameter> restore_parameters(const Scene& scene) { return mend_parameters(scene, false); }
std::vector<Parameter> fill_parameters(const Scene& scene) { return mend_parameters(scene, true); }

std::vector<Parameter> open_parameters(const Scene&) {
  return {open_file("File", {"ply", "obj", "off", "stl"}, "Model",
                    "A .ply, .obj, .off or .stl file, read as those of a model database are: with colours, texture "
                    "coordinates and textures, wherever the current folder is.")};
}

}  // namespace parts
