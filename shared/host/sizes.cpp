// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/host/sizes.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "host_api.h"
#include "parts/base/error.h"

namespace parts::host {

namespace {

// A head of 240 mm in 200 steps has noses of a few steps.
constexpr double kStepsOfAModel = 200, kStepsOfAnEdge = 2;

std::string shown(double value) {
  std::ostringstream out;
  out.precision(3);
  out << value;
  return out.str();
}

/// Of the finite faces: the box, and the mean length of edges with one.
struct Extent {
  Box box;
  double edge = 0;
};

Extent extent_of(const Mesh& mesh) {
  Extent e;
  double sum = 0;
  long edges = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 &a = mesh.corner(f, 0), &b = mesh.corner(f, 1), &c = mesh.corner(f, 2);
    if (!a.allFinite() || !b.allFinite() || !c.allFinite()) continue;
    e.box.extend(a).extend(b).extend(c);
    for (const double length : {(b - a).norm(), (c - b).norm(), (a - c).norm()})
      if (length > 0) sum += length, ++edges;
  }
  if (edges) e.edge = sum / edges;
  return e;
}

}  // namespace

double coordinate_step_at(double at) {
  const Scalarm x = std::abs(Scalarm(at));
  return std::isfinite(x) ? double(std::nextafter(x, std::numeric_limits<Scalarm>::infinity())) - double(x) : 0;
}

void check_size(const std::string& name, double value) {
  if (std::abs(value) > kLargestSize)
    throw UserError(name + " is " + shown(value) + ", too large to compute with; give at most " + shown(kLargestSize) +
                    ".");
}

void check_sizes(const Mesh& mesh, double step, const std::string& layer) {
  const Extent extent = extent_of(mesh);
  if (extent.box.isEmpty()) return;
  const double far = std::max(extent.box.min().cwiseAbs().maxCoeff(), extent.box.max().cwiseAbs().maxCoeff());
  const double size = extent.box.sizes().maxCoeff();
  const std::string the_layer = "The layer \"" + layer + "\" ";
  if (far > kLargestSize)
    throw UserError(the_layer + "has coordinates of " + shown(far) + ", too large to compute with; scale it down to " +
                    shown(kLargestSize) + " or less.");
  if (size > 0 && size < 1 / kLargestSize)
    throw UserError(the_layer + "is only " + shown(size) + " large, too small to compute with; scale it up to " +
                    shown(1 / kLargestSize) + " or more.");
  const double coarse = std::max(step, coordinate_step_at(far));
  if (size > 0 && (size < kStepsOfAModel * coarse || extent.edge < kStepsOfAnEdge * coarse))
    throw UserError("The coordinates of the layer \"" + layer + "\" are rounded to " + shown(coarse) +
                    ", as they lie far from the origin, which is too coarse for a model of size " + shown(size) +
                    "; move it to the origin in the program that made it, and load it again.");
}

}  // namespace parts::host
