// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a mesh in another format, bare or with a hole: inputs for the pictures
// and for trying the filters. MeshLab 2020.09 cannot open an .obj; this reads it.

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <vector>

#include "parts/io/mesh_io.h"
#include "parts/mesh/attributes.h"

namespace {

using namespace parts;

const char kUsage[] =
    "usage: convert IN OUT [--bare] [--without X,Y,Z,R]...\n"
    "Reads .ply .obj .off .stl, writes .ply .obj .off.\n"
    "  --bare             without colours, textures and quality\n"
    "  --without X,Y,Z,R  without the faces whose middle is nearer than R to a point\n";

Mesh bare(const Mesh& mesh) {
  Mesh shape;
  shape.vertices = mesh.vertices, shape.faces = mesh.faces;
  return shape;
}

/// @return false if the text is not four numbers
bool read_ball(const char* text, Vec3& center, double& radius) {
  int end = 0;
  return std::sscanf(text, "%lf,%lf,%lf,%lf%n", &center.x(), &center.y(), &center.z(), &radius, &end) == 4 &&
         text[end] == 0;
}

Mesh without_ball(const Mesh& mesh, const Vec3& center, double radius) {
  std::vector<char> keep;
  for (int f = 0; f < mesh.face_count(); ++f) keep.push_back((mesh.center(f) - center).norm() >= radius);
  return mesh::take_faces(mesh, keep);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs(kUsage, stderr);
    return 1;
  }
  try {
    Mesh mesh = io::read_mesh(argv[1]);
    for (int i = 3; i < argc; ++i) {
      Vec3 center;
      double radius = 0;
      if (std::strcmp(argv[i], "--bare") == 0) {
        mesh = bare(mesh);
      } else if (std::strcmp(argv[i], "--without") == 0 && i + 1 < argc && read_ball(argv[i + 1], center, radius)) {
        mesh = without_ball(mesh, center, radius);
        ++i;
      } else {
        std::fputs(kUsage, stderr);
        return 1;
      }
    }
    io::write_mesh(mesh, argv[2]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
