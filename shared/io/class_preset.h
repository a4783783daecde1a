// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>

#include "parts/base/files.h"
#include "parts/mesh/mesh.h"

namespace parts::io {

/// What a database says about its class (thesis 4.3.1: weights are set once a
/// class): how its models stand, and values for parameters of filters. Kept
/// in a file beside the database that MeshLab does not look at: heads.class.json
/// for heads.mlp, class.json in a folder of models.
///
///     { "Up": [0, 1, 0], "Front": [0, 0, 1],
///       "reconstruct_depth": { "PatchSizes": "5,7,9", "WeightPosition": 10 } }
struct ClassPreset {
  std::optional<Vec3> up, front;
  /// Values as text, by the slug of the filter and the name of its parameter.
  std::map<std::string, std::map<std::string, std::string>> values;

  /// @return nothing where the preset does not say
  std::optional<double> number(const std::string& filter, const std::string& parameter) const;
  std::optional<std::string> text(const std::string& filter, const std::string& parameter) const;
};

/// Where the preset of a database lies (which need not exist).
std::string class_preset_path(const std::string& database);

/// @return an empty one where there is no such file
/// @throws UserError  the file is there but cannot be read
ClassPreset read_class_preset(const std::string& database);

/// Parses the text of such a file. @return nothing if it is no JSON object, or nested too deeply to be one
std::optional<ClassPreset> parse_class_preset(const std::string& text);

/// Writes what the preset says; what else a file that is there already says stays.
/// @throws UserError  the file cannot be read or written
void write_class_preset(const ClassPreset& preset, const std::string& database);

/// The same as one of several files.
void add_class_preset(OutputFiles& files, const ClassPreset& preset, const std::string& database);

}  // namespace parts::io
