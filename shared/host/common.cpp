// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/host/common.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "parts/base/error.h"

namespace parts::host {

const char* const composition_reference =
    "<br><br>See:<br><i>T. Hassner, L. Zelnik-Manor, G. Leifman, R. Basri</i><br>"
    "<b>\"Minimal-cut model composition\"</b><br>Shape Modeling International 2005";

Mesh surface_of(const Layer& layer) {
  Mesh mesh = layer.mesh();
  if (mesh.faces.empty())
    throw UserError("The layer \"" + layer.name() + "\" has no faces; choose a layer that holds a surface.");
  return mesh;
}

Outcome::Check check_of_depth(bool solid) {
  Outcome::Check check;
  check.rules.may_part = true;
  check.rules.may_open = !solid;
  return check;
}

void add_box(const std::string& name, const std::string& label, const Box& box, std::vector<Parameter>& list) {
  const Vec3 low = box.isEmpty() ? Vec3(Vec3::Zero()) : box.min(), high = box.isEmpty() ? low : box.max();
  list.push_back(point(name + "Min", low, label + ": box, low corner",
                       "Used when the choice above is Box: the corner with the smallest x, y and z."));
  list.push_back(point(name + "Max", high, label + ": box, high corner",
                       "Used when the choice above is Box: the corner with the largest x, y and z."));
}

void add_smoothing(const std::string& zero, std::vector<Parameter>& list) {
  const seam::SeamSmoothing smoothing;
  list.push_back(integer("SmoothIterations", smoothing.iterations, 0, 10000, "Smoothing steps of the seam",
                         "How often the vertices near the seam move toward the middle of their neighbours. 0 leaves "
                         "the seam as it was stitched."));
  list.push_back(length(
      "SmoothDistance", smoothing.distance, "Smoothing distance",
      "Vertices up to this distance from the seam are smoothed, in the units of the models. 0 means " + zero + "."));
  list.push_back(number("SmoothWeight", smoothing.weight, 0, 1, "Smoothing weight",
                        "How far a vertex moves in each step: 0 not at all, 1 all the way to the middle of its "
                        "neighbours."));
}

seam::SeamSmoothing smoothing_of(const Inputs& inputs) {
  return {inputs.integer("SmoothIterations"), inputs.length("SmoothDistance"), inputs.number("SmoothWeight")};
}

Parameter cut_choice(std::string help) {
  Parameter cut = choice("Cut", 0, {"Mesh", "Thesis"}, "Cut", std::move(help));
  cut.max = 2;  // older scripts had a third choice, which means the first now
  return cut;
}

cut::Cut cut_of(const Inputs& inputs) { return inputs.choice("Cut") == 1 ? cut::Cut::Thesis : cut::Cut::Mesh; }

std::vector<int> parse_patch_sizes(const std::string& text) {
  std::vector<int> sizes;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) {
    std::istringstream number(word);
    int size = 0;
    std::string rest;
    if (!(number >> size) || number >> rest)
      throw UserError("PatchSizes is \"" + text + "\"; give odd numbers separated by commas, as in 5,7,9.");
    sizes.push_back(size);
  }
  if (sizes.empty()) throw UserError("PatchSizes is empty; give odd numbers separated by commas, as in 5,7,9.");
  return sizes;
}

double class_number(const Inputs& inputs, const io::ClassPreset& preset, const char* slug, const char* name,
                    double fallback) {
  const double given = inputs.number(name);
  return std::abs(given - fallback) < 1e-6 ? preset.number(slug, name).value_or(given) : given;
}

std::string class_text(const Inputs& inputs, const io::ClassPreset& preset, const char* slug, const char* name,
                       const std::string& fallback) {
  const std::string given = inputs.text(name);
  return given == fallback ? preset.text(slug, name).value_or(given) : given;
}

Vec3 class_direction(const Inputs& inputs, const char* name, const Vec3& fallback,
                     const std::optional<Vec3>& of_class) {
  const Vec3 given = inputs.point(name);
  return of_class && (given - fallback).norm() < 1e-6 ? *of_class : given;
}

void refuse_inputs(const Inputs& inputs, const std::vector<const char*>& outputs,
                   const std::vector<std::string>& input_files) {
  std::error_code missing;
  for (const char* output : outputs)
    for (const std::string& file : input_files)
      if (const std::string named = inputs.text(output);
          !named.empty() && !file.empty() && std::filesystem::equivalent(named, file, missing))
        throw UserError(std::string(output) + " is one of the inputs, which are not replaced; give another name.");
  std::map<std::filesystem::path, const char*> names;
  for (const char* output : outputs) {
    const std::string named = inputs.text(output);
    if (named.empty()) continue;
    const auto [other, is_new] = names.emplace(std::filesystem::weakly_canonical(named, missing), output);
    if (!is_new)
      throw UserError(std::string(other->second) + " and " + output + " are one file; give each a name of its own.");
  }
}

}  // namespace parts::host
