// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/mesh_io.h"

#include <algorithm>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "parts/io/mesh_formats.h"
#include "parts/io/sibling.h"
#include "parts/mesh/arrays.h"

namespace parts::io {
namespace {

namespace fs = std::filesystem;

/// Of a material library, or nothing.
std::optional<std::string> text_of(const fs::path& path) {
  try {
    return InputFile(path.string()).read_all();
  } catch (const UserError&) {
    return {};
  }
}

Mesh parse(const std::string& path, const std::string& bytes, const Poll& poll, std::vector<std::string>& missing) {
  const std::string format = lower_extension(path);
  if (format == ".ply") return formats::parse_ply(bytes, poll);
  if (format == ".off") return formats::parse_off(bytes, poll);
  if (format == ".stl") return formats::parse_stl(bytes, poll);
  const auto library = [&](const std::string& name) { return text_of(named_beside(path, name)); };
  return formats::parse_obj(bytes, library, missing, poll);
}

/// The mesh with textures named as seen from the file that it will be in.
Mesh with_textures_beside(const Mesh& mesh, const fs::path& file) {
  Mesh named = mesh;
  for (std::string& t : named.textures) {
    std::error_code error;
    const fs::path from_there = fs::relative(t, folder_of(file), error);
    if (!error && !from_there.empty() && fs::exists(t, error)) t = from_there.generic_string();
  }
  return named;
}

/// What parse() gives is whole, whatever the file says.
Mesh checked(Mesh mesh) {
  const std::string flaw = mesh::array_flaw(mesh);
  if (!flaw.empty()) throw formats::Malformed(flaw);
  if (mesh.faces.empty()) throw formats::Malformed("holds no face");
  return mesh;
}

}  // namespace

Mesh read_mesh(const std::string& path, const Poll& poll, std::vector<std::string>* missing) {
  const InputFile file(path);
  const std::string named = "The file \"" + path + "\" ", format = lower_extension(path);
  if (!ends_in(path, {".ply", ".obj", ".off", ".stl"}))
    throw UserError(named + "is not a mesh file that can be read; use .ply, .obj, .off or .stl.");
  std::vector<std::string> lost;
  try {
    const std::uint64_t needed = formats::check_head(format, file.read(0, formats::kHeadBytes), file.size());
    Mesh mesh = checked(parse(path, file.read_all(needed, poll), poll, lost));
    for (std::string& t : mesh.textures) {
      const fs::path place = named_beside(path, t);
      std::error_code error;
      if (!t.empty() && !fs::is_regular_file(place, error)) lost.push_back(t);
      t = place.string();
    }
    if (missing) *missing = std::move(lost);
    return mesh;
  } catch (const formats::Malformed& e) {
    throw UserError(named + e.what() + "; export the mesh again.");
  } catch (const std::bad_alloc&) {
    throw UserError(named + "needs more memory than there is; simplify the mesh first.");
  }
}

void add_mesh(OutputFiles& files, const Mesh& mesh, const std::string& path) {
  const std::string flaw = mesh::array_flaw(mesh), format = lower_extension(path);
  if (!flaw.empty()) throw std::logic_error("The mesh for \"" + path + "\" " + flaw);
  const Mesh named = mesh.textures.empty() ? Mesh() : with_textures_beside(mesh, path);
  const Mesh& out = mesh.textures.empty() ? mesh : named;
  if (format == ".ply") return files.add(path, formats::format_ply(out));
  if (format == ".off") return files.add(path, formats::format_off(out));
  if (format != ".obj")
    throw UserError("The file \"" + path + "\" has no ending that can be written; use .ply, .obj or .off.");
  const fs::path materials = path + ".mtl";
  const formats::ObjText text = formats::format_obj(out, materials.filename().string());
  if (!text.materials.empty()) files.add(materials, text.materials);
  files.add(path, text.obj);
}

void write_mesh(const Mesh& mesh, const std::string& path) {
  OutputFiles files;
  add_mesh(files, mesh, path);
  files.commit();
}

}  // namespace parts::io
