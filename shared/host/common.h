// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/cut.h"
#include "parts/host/filter.h"
#include "parts/io/class_preset.h"
#include "parts/seam/seam.h"

/// What filters of several plugins have in common: parameters, how their values
/// are read, and checks of inputs.
namespace parts::host {

/// Ends the help of filters after chapter 3 of the thesis.
extern const char* const composition_reference;

/// A layer's mesh. @throws UserError  it has no faces
Mesh surface_of(const Layer& layer);

/// Of a mesh made from depth: torn where the depth jumps, and open unless it has a back.
Outcome::Check check_of_depth(bool solid);

/// `name`Min and `name`Max: the corners of a box that a choice above asks for.
void add_box(const std::string& name, const std::string& label, const Box& box, std::vector<Parameter>& list);

/// SmoothIterations, SmoothDistance and SmoothWeight. @param zero  what a distance of 0 means
void add_smoothing(const std::string& zero, std::vector<Parameter>& list);
seam::SeamSmoothing smoothing_of(const Inputs& inputs);

/// The choice Cut.
Parameter cut_choice(std::string help);
cut::Cut cut_of(const Inputs& inputs);

/// Sides of patches, coarse to fine. @throws UserError  text is no list of whole numbers
std::vector<int> parse_patch_sizes(const std::string& text);

/// The value of a parameter; at its default, what the class says of it.
double class_number(const Inputs& inputs, const io::ClassPreset& preset, const char* slug, const char* name,
                    double fallback);
std::string class_text(const Inputs& inputs, const io::ClassPreset& preset, const char* slug, const char* name,
                       const std::string& fallback);

/// The value of a direction; at its default, what the class says.
Vec3 class_direction(const Inputs& inputs, const char* name, const Vec3& fallback, const std::optional<Vec3>& of_class);

/// @throws UserError  a file that an output parameter names is one of the
///                    inputs, or that of another output
void refuse_inputs(const Inputs& inputs, const std::vector<const char*>& outputs,
                   const std::vector<std::string>& input_files);

}  // namespace parts::host
