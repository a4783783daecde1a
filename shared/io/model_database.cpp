// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/model_database.h"

#include <Eigen/LU>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>

#include "parts/base/error.h"
#include "parts/io/mesh_io.h"
#include "parts/io/mlp_project.h"
#include "parts/mesh/attributes.h"

namespace parts::io {
namespace {

namespace fs = std::filesystem;

bool is_mesh_file(const fs::path& path) { return ends_in(path, {".ply", ".obj", ".off", ".stl"}); }

std::vector<fs::path> mesh_files(const fs::path& folder) {
  std::vector<fs::path> files;
  try {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      std::error_code error;
      if (name.front() != '.' && is_mesh_file(name) && !entry.is_directory(error)) files.push_back(entry.path());
    }
  } catch (const fs::filesystem_error&) {
    throw UserError("The folder \"" + folder.string() + "\" cannot be read; check that it may be opened.");
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

/// "x", "x (2)", "x (3)" for entries of the same name.
std::string unique_name(const std::string& name, std::map<std::string, int>& used) {
  std::string unique = name;
  for (int n = ++used[name]; n > 1 && used.count(unique = name + " (" + std::to_string(n) + ")"); ++n) {
  }
  if (unique != name) used[unique] = 1;
  return unique;
}

void use_world_space(Mesh& mesh, const Eigen::Matrix4d& matrix) {
  if (matrix == Eigen::Matrix4d::Identity()) return;
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  for (Vec3& v : mesh.vertices) v = (matrix * v.homogeneous()).hnormalized();
  if (linear.determinant() < 0) mesh::flip_orientation(mesh);
  if (mesh.vertex_normal.empty()) return;
  const Eigen::Matrix3f normals =
      (linear.inverse().transpose() * (linear.determinant() < 0 ? -1.0 : 1.0)).cast<float>();
  for (Eigen::Vector3f& n : mesh.vertex_normal) n = (normals * n).normalized();
}

/// Why a model cannot be used, or "".
std::string flaw(const Mesh& mesh) {
  if (mesh.faces.empty()) return "holds no face";
  Box box;
  for (const Triangle& f : mesh.faces)
    for (int v : f) {
      if (!mesh.vertices[v].allFinite()) return "has a coordinate that is not a number";
      box.extend(mesh.vertices[v]);
    }
  const double side = box.sizes().maxCoeff();
  if (!std::isfinite(side) || !std::isfinite(side * side)) return "has coordinates too large to be computed with";
  if (!(side > 0)) return "has no extent";
  return "";
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      while (i < a.size() && a[i] == '0') ++i;
      while (j < b.size() && b[j] == '0') ++j;
      std::size_t m = i, n = j;
      while (m < a.size() && digit(a[m])) ++m;
      while (n < b.size() && digit(b[n])) ++n;
      if (m - i != n - j) return m - i < n - j;
      if (const int order = a.compare(i, m - i, b, j, n - j)) return order < 0;
      i = m, j = n;
    } else {
      const int x = std::tolower(static_cast<unsigned char>(a[i])), y = std::tolower(static_cast<unsigned char>(b[j]));
      if (x != y) return x < y;
      ++i, ++j;
    }
  }
  if ((i == a.size()) != (j == b.size())) return i == a.size();
  return a < b;  // equal but for case or leading zeros
}

ModelDatabase::ModelDatabase(const std::string& given, Progress& progress) : path_(given) {
  std::error_code error;
  if (is_mesh_file(given) && fs::is_regular_file(given, error))  // file dialogs choose no folders
    path_ = fs::absolute(given).parent_path().string();
  const std::string& path = path_;
  if (path.empty())
    throw UserError("No model database is named; choose a MeshLab project (.mlp) or a folder of models.");
  const std::string database = "The model database \"" + path + "\" ";
  std::map<std::string, int> used;
  if (fs::is_directory(path, error)) {
    for (const fs::path& file : mesh_files(path))
      models_.push_back({unique_name(file.filename().string(), used), file.string()});
    if (models_.empty())
      throw UserError(database + "has no .ply, .obj, .off or .stl file in it; choose another folder.");
    return;
  }
  if (!fs::exists(path, error)) throw UserError(database + "does not exist; check its name and folder.");
  if (!ends_in(path, {".mlp"}))
    throw UserError(database + "is neither a folder nor a MeshLab project (.mlp); choose one of these.");
  for (const MlpMesh& mesh : read_mlp(path).meshes) {
    const std::string name =
        unique_name(mesh.label.empty() ? fs::path(mesh.file).filename().string() : mesh.label, used);
    if (!fs::is_regular_file(mesh.file, error))
      progress.log("skipped: " + name + " (The file \"" + mesh.file + "\" does not exist)");
    else if (std::abs(mesh.matrix.topLeftCorner<3, 3>().determinant()) == 0 || mesh.matrix(3, 3) == 0)
      progress.log("skipped: " + name + " (its matrix flattens it)");
    else
      models_.push_back({name, mesh.file, mesh.matrix});
  }
  if (models_.empty()) throw UserError(database + "has no mesh that can be read; add models to the project.");
}

ModelDatabase::ModelDatabase(std::vector<std::pair<std::string, Mesh>> models) {
  for (auto& [name, mesh] : models)
    models_.push_back({name, {}, Eigen::Matrix4d::Identity(), std::make_shared<const Mesh>(std::move(mesh))});
}

void log_missing(const std::string& model, const std::vector<std::string>& missing, Progress& progress) {
  for (const std::string& name : missing) progress.log("missing: " + model + " (it names \"" + name + "\")");
}

Mesh ModelDatabase::load(int model, const Poll& poll, std::vector<std::string>* missing) const {
  const Model& m = models_.at(std::size_t(model));
  Mesh mesh = m.mesh ? *m.mesh : read_mesh(m.file, poll, missing);
  use_world_space(mesh, m.matrix);
  const std::string why = flaw(mesh);
  if (!why.empty()) throw UserError("The model \"" + m.name + "\" " + why + "; repair it or take it out.");
  const bool stray =
      std::any_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& v) { return !v.allFinite(); });
  return stray ? mesh::take_faces(mesh, std::vector<char>(mesh.faces.size(), 1)) : mesh;
}

std::optional<Mesh> ModelDatabase::load_or_skip(int model, Progress& progress) const {
  try {
    std::vector<std::string> missing;
    Mesh mesh = load(model, {}, &missing);
    log_missing(name(model), missing, progress);
    return mesh;
  } catch (const UserError& e) {
    progress.log("skipped: " + name(model) + " (" + e.what() + ")");
    return {};
  }
}

}  // namespace parts::io
