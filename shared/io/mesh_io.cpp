// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/mesh_io.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <new>

#include "parts/base/error.h"
#include "parts/io/mesh_formats.h"

namespace parts::io {
namespace {

namespace fs = std::filesystem;

std::string extension(const std::string& path) {
  std::string e = fs::path(path).extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return e;
}

/// The whole file, or nothing if it cannot be read (a folder, say).
std::optional<std::string> contents(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return {};
  std::ifstream file(path, std::ios::binary);
  std::string bytes(std::size_t(fs::file_size(path, error)), '\0');
  if (!file || error || !file.read(bytes.data(), std::streamsize(bytes.size()))) return {};
  return bytes;
}

/// Where a file named inside the mesh file lies: beside the mesh file.
fs::path sibling(const fs::path& mesh_file, std::string name) {
  const auto beside = [&](const std::string& n) { return (mesh_file.parent_path() / n).lexically_normal(); };
  std::error_code error;
  if (!fs::exists(beside(name), error)) {  // written on another system, or with the folders of another machine
    std::string slashed = name;
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    if (fs::exists(beside(slashed), error)) return beside(slashed);
    const std::string bare = slashed.substr(slashed.find_last_of('/') + 1);
    if (!bare.empty() && fs::exists(beside(bare), error)) return beside(bare);
  }
  return beside(name);
}

Mesh parse(const std::string& path, const std::string& bytes) {
  const std::string format = extension(path);
  if (format == ".ply") return formats::parse_ply(bytes);
  if (format == ".off") return formats::parse_off(bytes);
  if (format == ".stl") return formats::parse_stl(bytes);
  return formats::parse_obj(bytes, [&](const std::string& name) { return contents(sibling(path, name)); });
}

/// The mesh with textures named as seen from the file that it will be in.
Mesh with_textures_beside(const Mesh& mesh, const fs::path& file) {
  Mesh named = mesh;
  for (std::string& t : named.textures) {
    std::error_code error;
    const fs::path from_there = fs::relative(t, file.has_parent_path() ? file.parent_path() : ".", error);
    if (!error && !from_there.empty() && fs::exists(t, error)) t = from_there.generic_string();
  }
  return named;
}

/// Replaces the file only once all is written.
void write_file(const fs::path& path, const std::string& bytes) {
  const UserError failed("The file \"" + path.string() + "\" cannot be written; check its folder and the space left.");
  std::error_code error;
  const bool replace = !fs::exists(path, error) || fs::is_regular_file(path, error);
  fs::path draft = path;
  if (replace) draft += ".part";
  std::ofstream file(draft, std::ios::binary);
  file.write(bytes.data(), std::streamsize(bytes.size()));
  file.close();
  const bool written = bool(file);
  if (written && replace) fs::rename(draft, path, error);
  if (!written || error) {
    if (replace) fs::remove(draft, error);
    throw failed;
  }
}

}  // namespace

Mesh read_mesh(const std::string& path) {
  const std::string file = "The file \"" + path + "\" ";
  const std::string format = extension(path);
  std::error_code error;
  if (!fs::exists(path, error)) throw UserError(file + "does not exist; check its name and folder.");
  if (format != ".ply" && format != ".obj" && format != ".off" && format != ".stl")
    throw UserError(file + "is not a mesh file that can be read; use .ply, .obj, .off or .stl.");
  try {
    const std::optional<std::string> bytes = contents(path);
    if (!bytes) throw UserError(file + "cannot be read; check that it is a file and may be opened.");
    if (bytes->empty()) throw formats::Malformed("is empty");
    Mesh mesh = parse(path, *bytes);
    if (mesh.faces.empty()) throw formats::Malformed("holds no face");
    for (std::string& t : mesh.textures) t = sibling(path, t).string();
    return mesh;
  } catch (const formats::Malformed& e) {
    throw UserError(file + e.what() + "; export the mesh again.");
  } catch (const std::bad_alloc&) {
    throw UserError(file + "needs more memory than there is; simplify the mesh first.");
  }
}

void write_mesh(const Mesh& mesh, const std::string& path) {
  const std::string format = extension(path);
  const Mesh named = mesh.textures.empty() ? Mesh() : with_textures_beside(mesh, path);
  const Mesh& out = mesh.textures.empty() ? mesh : named;
  if (format == ".ply") return write_file(path, formats::format_ply(out));
  if (format == ".off") return write_file(path, formats::format_off(out));
  if (format != ".obj")
    throw UserError("The file \"" + path + "\" has no ending that can be written; use .ply, .obj or .off.");
  const fs::path materials = path + ".mtl";
  const formats::ObjText text = formats::format_obj(out, materials.filename().string());
  if (!text.materials.empty()) write_file(materials, text.materials);
  write_file(path, text.obj);
}

}  // namespace parts::io
