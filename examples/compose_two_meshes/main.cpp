// SPDX-License-Identifier: GPL-3.0-or-later
// Composes two overlapping meshes: the top of the first on the bottom of the second.
#include <cstdio>

#include "parts/compose/compose.h"
#include "parts/compose/constraint.h"
#include "parts/io/mesh_io.h"

using parts::Box, parts::Mesh, parts::compose::ConstraintBy;

// Which faces must survive: those in the top or the bottom tenth of a mesh.
static std::vector<char> keep_end(const Mesh& mesh, bool top, const char* name) {
  Box end = mesh.bounds();
  const double y = end.min().y() + (top ? 0.9 : 0.1) * end.sizes().y();
  (top ? end.min() : end.max()).y() = y;
  return parts::compose::constrained_faces(mesh, ConstraintBy::Box, end.min(), end.max(), name);
}

int main(int count, char** arguments) try {
  if (count != 4) throw parts::UserError("Give three files: the upper mesh, the lower mesh, the result.");
  const Mesh a = parts::io::read_mesh(arguments[1]), b = parts::io::read_mesh(arguments[2]);
  parts::Progress progress(
      [](int percent, const char* stage) { return std::printf("%d %% %s\n", percent, stage) > 0; });
  const parts::compose::ComposeResult result = parts::compose::compose(
      {a, keep_end(a, true, "the upper mesh")}, {b, keep_end(b, false, "the lower mesh")}, {}, progress);
  parts::io::write_mesh(result.composed, arguments[3]);
  std::printf("%d faces in %s\n", result.composed.face_count(), arguments[3]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
