// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "parts/base/files.h"
#include "parts/base/progress.h"
#include "parts/mesh/mesh.h"

namespace parts::io {

/// A database of models: the meshes of a MeshLab project (.mlp) with their
/// matrices, or all .ply .obj .off .stl files of a folder, in natural order
/// (head_2 before head_10). Opening it lists the models and reads none: they are
/// loaded one at a time, so that hundreds need no more memory than one.
class ModelDatabase {
 public:
  /// Models that are not there are left out and logged, "skipped: name (why)".
  /// @param given  the project or folder; a mesh file stands for its folder
  /// @throws UserError  no such folder or project, or no model in it
  ModelDatabase(const std::string& given, Progress& progress);

  /// Of models that are in memory, not in files. Their names are unique.
  explicit ModelDatabase(std::vector<std::pair<std::string, Mesh>> models);

  const std::string& path() const { return path_; }
  int size() const { return int(models_.size()); }
  const std::string& name(int model) const { return models_[model].name; }  ///< unique
  const std::string& file(int model) const { return models_[model].file; }
  const Eigen::Matrix4d& matrix(int model) const { return models_[model].matrix; }  ///< file's to world space

  /// The model in world space, with all its attributes; oriented as in its file
  /// even where its matrix mirrors.
  /// @param missing  optional: materials and textures that it names and that are not there
  /// @throws UserError  it cannot be read, or has no face, no extent or a
  ///                    coordinate that is not finite
  Mesh load(int model, const Poll& poll = {}, std::vector<std::string>* missing = nullptr) const;

  /// The same, but a model that cannot be used is logged, "skipped: name (why)", and
  /// nothing; what it names and is not there is logged too, "missing: name (what)".
  std::optional<Mesh> load_or_skip(int model, Progress& progress) const;

 private:
  struct Model {
    std::string name, file;
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    std::shared_ptr<const Mesh> mesh = nullptr;  ///< of a model without a file
  };
  std::string path_;
  std::vector<Model> models_;
};

/// Logs what a model names and is not there.
void log_missing(const std::string& model, const std::vector<std::string>& missing, Progress& progress);

/// Whether a comes before b where runs of digits count as numbers.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace parts::io
