// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <cstring>
#include <unordered_map>

#include "parts/io/mesh_formats.h"

namespace parts::io::formats {
namespace {

constexpr std::size_t kHeader = 80, kRecord = 50;

/// Makes bit-identical corners one vertex (0 and -0 are the same).
class Welder {
 public:
  explicit Welder(Mesh& mesh) : mesh_(mesh) {}
  int vertex(Eigen::Vector3f p) {
    p += Eigen::Vector3f::Zero();  // -0 becomes 0
    Key key;
    std::memcpy(key.data(), p.data(), sizeof key);
    const auto [it, added] = ids_.try_emplace(key, mesh_.vertex_count());
    if (added) mesh_.vertices.push_back(p.cast<double>());
    return it->second;
  }

 private:
  using Key = std::array<std::uint32_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& k) const {
      std::uint64_t h = 0;
      for (std::uint32_t x : k) h = (h ^ x) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
      return h;
    }
  };
  Mesh& mesh_;
  std::unordered_map<Key, int, Hash> ids_;
};

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// The bytes of a binary file by its count of faces; 0 without one.
std::uint64_t binary_size(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() < kHeader + 4) return 0;
  std::memcpy(&count, bytes.data() + kHeader, sizeof count);
  return kHeader + 4 + std::uint64_t(count) * kRecord;
}

/// Some binary files begin with "solid" too; only text has no zero bytes.
bool is_text(std::string_view bytes) {
  const std::string start = lower(bytes.substr(0, kHeadBytes));
  return start.find("solid") != start.npos && start.find('\0') == start.npos;
}

Mesh parse_binary(std::string_view bytes, std::size_t faces, Pace pace) {
  Mesh mesh;
  Welder weld(mesh);
  // Two conventions for a face's 15 bits of colour, by the header.
  const std::string_view header = bytes.substr(0, kHeader);
  const bool magics = header.find("COLOR=") != header.npos;
  bool colored = false;
  mesh.faces.reserve(faces);
  for (std::size_t f = 0; f < faces; ++f) {
    pace.step();
    const char* record = bytes.data() + kHeader + 4 + f * kRecord;
    Eigen::Matrix3f p;  // a corner a column
    std::uint16_t bits;
    std::memcpy(p.data(), record + 12, 9 * sizeof(float));
    std::memcpy(&bits, record + 48, sizeof bits);
    mesh.faces.push_back({weld.vertex(p.col(0)), weld.vertex(p.col(1)), weld.vertex(p.col(2))});
    Color c{255, 255, 255, 255};
    if ((bits & 0x8000) ? !magics : magics) {
      for (int k = 0; k < 3; ++k) c[magics ? k : 2 - k] = std::uint8_t((bits >> (5 * k) & 31) * 255 / 31);
      colored = true;
    }
    mesh.face_color.push_back(c);
  }
  if (!colored) mesh.face_color.clear();
  return mesh;
}

Mesh parse_text(std::string_view bytes, Pace pace) {
  Mesh mesh;
  Welder weld(mesh);
  Triangle t{};
  int corners = 0;
  for (Scanner file(bytes); !file.done();) {
    pace.step();
    const std::string word = lower(file.word());
    if (word == "solid" || word == "endsolid") {
      file.line();  // a name, which may be any word
    } else if (word == "vertex") {
      if (corners == 3) throw Malformed("has a facet with more than three corners");
      Eigen::Vector3f p;
      for (float& x : p) x = float(file.number());
      t[corners++] = weld.vertex(p);
    } else if (word == "endfacet" || word == "endloop") {
      if (corners == 3) mesh.faces.push_back(t);
      corners = 0;
    }
  }
  if (corners) throw Malformed("ends in the middle of the data");
  return mesh;
}

}  // namespace

std::uint64_t stl_size(std::string_view head, std::uint64_t size) {
  const std::uint64_t binary = binary_size(head);
  if (binary != size && is_text(head)) return size;
  if (binary == 0 || size < binary) throw Malformed("is shorter than its header says");
  return binary;
}

Mesh parse_stl(std::string_view bytes, const Poll& poll) {
  const std::uint64_t binary = binary_size(bytes);
  if (binary != bytes.size() && is_text(bytes)) return parse_text(bytes, Pace(poll));
  if (binary == 0 || bytes.size() < binary) throw Malformed("is shorter than its header says");
  return parse_binary(bytes, std::size_t((binary - kHeader - 4) / kRecord), Pace(poll));
}

}  // namespace parts::io::formats
