// SPDX-License-Identifier: GPL-3.0-or-later
// Prints what is wrong with the surfaces in mesh files.

#include <cstdio>
#include <cstring>
#include <exception>

#include "parts/io/mesh_io.h"
#include "parts/mesh/result_check.h"
#include "parts/mesh/self_intersections.h"
#include "parts/mesh/topology.h"

namespace {

const char kUsage[] =
    "usage: meshcheck [--strict] [--welded] MESH...\n"
    "Counts the flaws of each mesh, one \"name: value\" a line.\n"
    "  --welded  also what the filters log of a result: single precision,\n"
    "            vertices at one place taken as one (docs/log.md)\n"
    "  --strict  end with 1 unless every mesh is closed, oriented, 2-manifold\n"
    "            and free of self-intersections and faces without area\n";

constexpr long kEnough = 1000000;  // self-intersections, where a mesh lies on itself

void report_welded(const parts::Mesh& mesh) {
  const parts::mesh::SurfaceFigures s = parts::mesh::measure_surface(parts::mesh::in_single_precision(mesh));
  std::printf("result_pieces: %d\nresult_borders: %d\nresult_nonmanifold: %zu\nresult_pinches: %zu\n", s.pieces,
              s.borders, s.nonmanifold.size(), s.pinches.size());
  std::printf("result_flipped: %zu\nresult_crossings: %zu\nenclosed volume: %.9g\n", s.flipped.size(),
              s.crossings.size(), s.volume);
}

bool report(const char* file, bool welded) {
  const parts::Mesh mesh = parts::io::read_mesh(file);
  const parts::mesh::MeshCheck c = parts::mesh::check(mesh);
  const long crossings = parts::mesh::self_intersections(mesh, kEnough);
  std::printf("file: %s\n%sself-intersections: %ld%s\n", file, parts::mesh::to_string(c).c_str(), crossings,
              crossings == kEnough ? " or more" : "");
  if (welded) report_welded(mesh);
  return c.closed() && c.oriented() && c.manifold() && c.degenerate_faces == 0 && crossings == 0;
}

}  // namespace

int main(int argc, char** argv) {
  bool strict = false, welded = false, clean = true;
  int files = 0;
  try {
    for (int i = 1; i < argc; ++i) {
      if (std::strcmp(argv[i], "--strict") == 0) {
        strict = true;
        continue;
      }
      if (std::strcmp(argv[i], "--welded") == 0) {
        welded = true;
        continue;
      }
      if (files++) std::printf("\n");
      clean &= report(argv[i], welded);
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
