// SPDX-License-Identifier: GPL-3.0-or-later
// Prints what is wrong with the surfaces in mesh files.

#include <cstdio>
#include <cstring>
#include <exception>

#include "parts/io/mesh_io.h"
#include "parts/mesh/self_intersections.h"
#include "parts/mesh/topology.h"

namespace {

const char kUsage[] =
    "usage: meshcheck [--strict] MESH...\n"
    "Counts the flaws of each mesh, one \"name: value\" a line.\n"
    "  --strict  end with 1 unless every mesh is closed, oriented, 2-manifold\n"
    "            and free of self-intersections and faces without area\n";

constexpr long kEnough = 1000000;  // self-intersections, where a mesh lies on itself

bool report(const char* file) {
  const parts::Mesh mesh = parts::io::read_mesh(file);
  const parts::mesh::MeshCheck c = parts::mesh::check(mesh);
  const long crossings = parts::mesh::self_intersections(mesh, kEnough);
  std::printf("file: %s\n%sself-intersections: %ld%s\n", file, parts::mesh::to_string(c).c_str(), crossings,
              crossings == kEnough ? " or more" : "");
  return c.closed() && c.oriented() && c.manifold() && c.degenerate_faces == 0 && crossings == 0;
}

}  // namespace

int main(int argc, char** argv) {
  bool strict = false, clean = true;
  int files = 0;
  try {
    for (int i = 1; i < argc; ++i) {
      if (std::strcmp(argv[i], "--strict") == 0) {
        strict = true;
        continue;
      }
      if (files++) std::printf("\n");
      clean &= report(argv[i]);
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "meshcheck: %s\n", e.what());
    return 1;
  }
  if (!files) {
    std::fputs(kUsage, stderr);
    return 2;
  }
  return strict && !clean ? 1 : 0;
}
