// SPDX-License-Identifier: GPL-3.0-or-later
//
// libFuzzer's entry to one of the readers, by PARTS_FUZZ_READER (see
// CMakeLists.txt): whatever the bytes, a whole result or the reader's own error.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "parts/base/files.h"
#include "parts/io/class_preset.h"
#include "parts/io/image_head.h"
#include "parts/io/manifest.h"
#include "parts/io/mesh_formats.h"
#include "parts/io/mlp_project.h"
#include "parts/io/pfm.h"
#include "parts/io/raster_io.h"
#include "parts/mesh/arrays.h"
#include "parts/search/raster_file.h"

namespace parts::fuzz {
namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

/// What is read can be written, and what is written read.
[[maybe_unused]] void check(const Mesh& mesh) {
  require(mesh::array_flaw(mesh).empty());
  const Mesh again = io::formats::parse_ply(io::formats::format_ply(mesh));
  require(again.faces == mesh.faces && again.vertex_count() == mesh.vertex_count());
  io::formats::format_off(mesh);
  io::formats::format_obj(mesh, "m.mtl");
}

[[maybe_unused]] void ply(const std::string& bytes) { check(io::formats::parse_ply(bytes)); }
[[maybe_unused]] void off(const std::string& bytes) { check(io::formats::parse_off(bytes)); }
[[maybe_unused]] void stl(const std::string& bytes) { check(io::formats::parse_stl(bytes)); }

/// The material library is the text behind the first zero.
[[maybe_unused]] void obj(const std::string& bytes) {
  const std::size_t end = bytes.find('\0');
  std::vector<std::string> missing;
  check(io::formats::parse_obj(
      bytes.substr(0, end),
      [&](const std::string&) {
        return end == bytes.npos ? std::nullopt : std::optional<std::string>(bytes.substr(end + 1));
      },
      missing));
}

[[maybe_unused]] void mlp(const std::string& bytes) {
  const io::MlpProject project = io::parse_mlp(bytes);
  for (const io::MlpMesh& mesh : project.meshes) require(mesh.matrix.allFinite());
}

[[maybe_unused]] void json(const std::string& bytes) {
  if (const auto preset = io::parse_class_preset(bytes)) require(!preset->up || preset->up->allFinite());
}

[[maybe_unused]] void cache(const std::string& bytes) {
  search::decode_raster(bytes, {1, 2, 3, 4, 2});
  search::decode_raster_body(bytes, 2);
}

/// A file in memory that the readers of images open by its name.
struct MemoryFile {
  explicit MemoryFile(const std::string& bytes) : path("/dev/shm/parts_fuzz_" + std::to_string(::getpid())) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    require(file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() && std::fclose(file) == 0);
  }
  ~MemoryFile() { ::unlink(path.c_str()); }
  std::string path;
};

[[maybe_unused]] void image(const std::string& bytes) {
  const cv::Mat map = io::parse_pfm(bytes);
  require(map.empty() || map.total() * map.elemSize() <= bytes.size());
  const auto head = io::read_image_head(bytes);
  if (!head || head->width * head->height > 1e5) return;
  const MemoryFile file(bytes);
  try {
    require(!io::read_depth(file.path).empty());
  } catch (const UserError&) {
  }
  require(!io::read_image(file.path).color.empty());
}

}  // namespace
}  // namespace parts::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    parts::fuzz::PARTS_FUZZ_READER(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const parts::io::formats::Malformed&) {
  } catch (const parts::UserError&) {
  }
  return 0;
}
