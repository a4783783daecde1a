// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/constraint.h"

#include "parts/base/error.h"
#include "parts/cut/volume.h"
#include "parts/spatial/triangle.h"

namespace parts::compose {
namespace {

void mark_nearest(const Mesh& mesh, const Vec3& point, std::vector<char>& keep) {
  int nearest = -1;
  double least = 1e300;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 closest = spatial::closest_on_triangle({mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)}, point);
    if (const double d = (closest - point).squaredNorm(); d < least) least = d, nearest = f;
  }
  if (nearest >= 0) keep[nearest] = 1;
}

void mark_touching(const Mesh& mesh, const Box& box, std::vector<char>& keep) {
  for (int f = 0; f < mesh.face_count(); ++f) keep[f] |= cut::touches(mesh, f, box);
}

}  // namespace

std::vector<char> constrained_faces(const Mesh& mesh, ConstraintBy by, const Vec3& box_min, const Vec3& box_max,
                                    const char* model, Mark mark) {
  const std::string of = std::string(" of ") + model, to = mark == Mark::Keep ? "to keep" : "to drop",
                    must = mark == Mark::Keep ? "must survive" : "must go";
  if (mesh.faces.empty()) throw UserError("No face" + of + " exists; choose a layer that holds a triangle mesh.");
  std::vector<char> keep(mesh.faces.size(), 0);
  if (by == ConstraintBy::SelectedFaces) {
    if (!mesh.face_selected.empty()) keep = mesh.face_selected;
  } else if (by == ConstraintBy::SelectedVertices) {
    if (!mesh.vertex_selected.empty())
      for (int f = 0; f < mesh.face_count(); ++f)
        for (int v : mesh.faces[f]) keep[f] |= mesh.vertex_selected[v];
  } else {
    if (!box_min.allFinite() || !box_max.allFinite())
      throw UserError("The box " + to + of + " is not finite; give its corners in world units.");
    if ((box_max - box_min).minCoeff() < 0)
      throw UserError("The box " + to + of +
                      " is inside out; every coordinate of its Max must be at least that of its Min.");
    if (box_min == box_max)
      mark_nearest(mesh, box_min, keep);
    else
      mark_touching(mesh, Box(box_min, box_max), keep);
  }
  if (std::find(keep.begin(), keep.end(), 1) == keep.end()) {
    if (by == ConstraintBy::SelectedFaces)
      throw UserError("No face" + of + " is selected; select the faces that " + must + ", or give a box or a point.");
    if (by == ConstraintBy::SelectedVertices)
      throw UserError("No vertex" + of + " with a face is selected; select the vertices that " + must +
                      ", or give a box or a point.");
    throw UserError("The box " + to + of + " touches no face of it; move or enlarge the box.");
  }
  return keep;
}

}  // namespace parts::compose
