// SPDX-License-Identifier: GPL-3.0-or-later
// Names and types are relied on by scripts outside the project: they do not change.
#include "parameters.h"

#include "parts/align/align.h"
#include "parts/compose/deform.h"
#include "parts/host/common.h"

namespace parts {

namespace {

using namespace host;

const double any = 1e30;

Vec3 middle(const Box& box) { return box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.center()); }

/// A constraint: a choice of ConstraintBy and the two corners of its box.
void add_constraint(const std::string& name, int by, const std::string& label, const std::string& what,
                    std::vector<Parameter>& list) {
  list.push_back(choice(name, by, {"Selected faces", "Selected vertices", "Box"}, label,
                        "How you mark " + what +
                            ": the faces selected on the layer, the faces around its selected vertices, or the faces "
                            "that a box touches. A few faces are enough; the cut finds the rest."));
  list.push_back(point(name + "Min", Vec3::Zero(), label + ": box, low corner",
                       "Used when the choice above is Box: the corner with the smallest x, y and z. The same point "
                       "twice marks the face nearest to it."));
  list.push_back(point(name + "Max", Vec3::Zero(), label + ": box, high corner",
                       "Used when the choice above is Box: the corner with the largest x, y and z."));
}

/// A part that must go: none, or a choice of ConstraintBy but for the selected faces.
void add_drop(const std::string& name, const std::string& label, const std::string& model,
              std::vector<Parameter>& list) {
  list.push_back(choice(name, 0, {"None", "Selected vertices", "Box"}, label,
                        "How you mark what must go of " + model +
                            ", where the cut would leave too much: the faces around its selected vertices, or those "
                            "that a box touches. What is marked to be kept stays. For the cut Mesh."));
  list.push_back(point(name + "Min", Vec3::Zero(), label + ": box, low corner",
                       "Used when the choice above is Box: the corner with the smallest x, y and z."));
  list.push_back(point(name + "Max", Vec3::Zero(), label + ": box, high corner",
                       "Used when the choice above is Box: the corner with the largest x, y and z."));
}

/// What Compose and Deform have in common, in two places of their dialogs.
void add_cut(std::vector<Parameter>& list) {
  const compose::ComposeOptions options;
  list.push_back(integer("Resolution", options.resolution, 0, 100000, "Resolution (voxels)",
                         "Of the cut Thesis: voxels along the longest side of the volume in which the models are "
                         "joined. 0 chooses from the meshes and the free memory."));
  list.push_back(cut_choice(
      "Mesh: the minimal cut on a graph of the faces of the models, smooth borders (best for most). Thesis: the "
      "published weights as printed, through voxels, borders along their sides."));
  list.push_back(length("BlendDistance", options.smoothing.blend_distance, "Blending distance",
                        "Both surfaces give way up to this distance from the seam, so that they meet without a step or "
                        "a crease; their details stay. 0 chooses from how they meet (with the cut Thesis: not at all). "
                        "Less than an edge leaves the seam as it is."));
}

}  // namespace

std::vector<Parameter> align_parameters(const Scene&) {
  const align::AlignOptions options;
  return {
      current_layer("MovingMesh", "Moving layer", "The layer that is moved as a whole."),
      other_layer("FixedMesh", "Fixed layer", "The layer that it is placed on; it does not change."),
      flag("OnlySelected", true, "Match the selected faces only",
           "Compares only the selected faces of each layer, for instance the two heads. A layer without selected "
           "faces is compared as a whole."),
      choice("Coarse", options.coarse ? 0 : 1, {"PCA", "None"}, "First guess",
             "PCA: wherever the models are, their principal axes are brought together in every way that is possible, "
             "and each is tried. None: starts from where the models are now; choose it when they are nearly placed."),
      flag("AllowScale", options.allow_scale, "Allow a change of size",
           "The moving layer may grow or shrink, equally in all directions."),
      flag("AllowMirror", options.allow_mirror, "Allow a reflection",
           "The moving layer may be mirrored: a left hand may become a right one."),
      integer("MaxIterations", options.max_iterations, 0, 100000, "Most steps",
              "The refinement stops after so many steps, or earlier when it no longer improves. 0 keeps the first "
              "guess."),
      number("Overlap", options.overlap, 0.01, 1, "Share that matches",
             "The share of the moving part that has a counterpart on the fixed one, from 0 to 1. The worst matching "
             "rest is left out at each step."),
      choice("ApplyTo", 0, {"Layer matrix", "Vertex coordinates"}, "Apply to",
             "Layer matrix: the layer gets a matrix and its coordinates stay, so that it can be moved on; saving a "
             "mesh file ignores the matrix. Vertex coordinates: the coordinates change and the matrix becomes the "
             "identity, so that mesh files are saved as seen."),
  };
}

std::vector<Parameter> compose_parameters(const Scene& scene) {
  const compose::ComposeOptions options;
  const Box volume = scene.current.merged(scene.other);
  std::vector<Parameter> list = {
      current_layer("MeshA", "Model A", "The first model."),
      other_layer("MeshB", "Model B", "The second model; it overlaps the first where they are to be joined."),
  };
  add_constraint("KeepA", 0, "Keep of A", "what must survive of A", list);
  add_constraint("KeepB", 0, "Keep of B", "what must survive of B", list);
  add_drop("DropA", "Drop of A", "A", list);
  add_drop("DropB", "Drop of B", "B", list);
  list.push_back(choice("Volume", 0, {"Union of the bounding boxes", "Box"}, "Where to join",
                        "The part of space in which the cut may pass. Outside of it nothing is cut: what lies there is "
                        "kept or dropped as a whole, with the surface that it continues."));
  add_box("Volume", "Where to join", volume, list);
  add_cut(list);
  list.push_back(flag("Stitch", options.stitch, "Stitch",
                      "Joins the borders of the two clipped models. Without it the result holds both clipped models as "
                      "they are: a hat on a head."));
  add_smoothing("two edges of the seam (two voxels with the cut Thesis)", list);
  list.push_back(flag("AddClippedLayers", false, "Add the clipped models",
                      "Adds what is left of each model as the layers \"Clipped A\" and \"Clipped B\", hidden."));
  list.push_back(flag("AddTransitionSurface", options.transition_surface, "Add the transition surface",
                      "Adds the surface along which the models were cut as the layer \"Transition surface\", hidden."));
  return list;
}

std::vector<Parameter> deform_parameters(const Scene& scene) {
  const compose::RigidPose pose;
  std::vector<Parameter> list = {current_layer("Mesh", "Model", "The model to bend; the result is a new layer.")};
  add_constraint("Fixed", 0, "Fixed part", "what stays where it is", list);
  add_constraint("Moving", 1, "Moving part", "what moves", list);
  list.push_back(point("Pivot", middle(scene.current), "Pivot",
                       "The point about which the moving part turns, grows or is mirrored: the joint."));
  list.push_back(point("Axis", pose.axis, "Axis",
                       "The direction about which the moving part turns, counter-clockwise when it points at you; the "
                       "mirror's direction too. Its length does not matter."));
  list.push_back(number("Angle", 30, -any, any, "Angle (degrees)", "How far the moving part turns about the axis."));
  list.push_back(point("Translation", pose.translation, "Shift",
                       "How far the moving part is shifted after it has turned, in the units of the model."));
  list.push_back(number("Scale", pose.scale, 1e-6, 1e6, "Scale",
                        "How much the moving part grows about the pivot; 1 keeps its size."));
  list.push_back(flag("Mirror", pose.mirror, "Mirror",
                      "Mirrors the moving part, before it turns, through the plane at the pivot across the axis."));
  list.push_back(integer("Frames", 1, 1, 1000, "Frames",
                         "1 gives the final pose. A larger number gives so many layers, from the model at rest to the "
                         "final pose."));
  add_cut(list);
  add_smoothing("as much as keeps the bend from folding (two voxels with the cut Thesis)", list);
  return list;
}

}  // namespace parts
