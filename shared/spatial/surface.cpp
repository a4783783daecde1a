// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/spatial/surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "parts/base/error.h"

namespace parts::spatial {
namespace {

using Corners = std::array<Vec3, 3>;

double triangle_area(const Corners& t) { return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm(); }

std::vector<Corners> emphasised(const Mesh& mesh, const std::vector<char>& flags, const std::string& model) {
  if (mesh.faces.empty())
    throw UserError("The " + model + " model has no faces: choose a layer that holds a triangle mesh.");
  if (!flags.empty() && flags.size() != mesh.faces.size()) throw std::invalid_argument("one flag a face");
  const bool all = std::find(flags.begin(), flags.end(), 1) == flags.end();
  std::vector<Corners> corners;
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!all && !flags[f]) continue;
    corners.push_back({mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)});
    for (const Vec3& v : corners.back())
      if (!v.allFinite())
        throw UserError("The " + model +
                        " part has a coordinate that is not a number: remove such vertices, then align again.");
  }
  return corners;
}

/// Moves the corners' box to the unit cube; returns its centre and longest side.
std::pair<Vec3, double> normalise_box(std::vector<Corners>& corners, const std::string& no_area) {
  Box box;
  for (const Corners& t : corners)
    for (const Vec3& v : t) box.extend(v);
  const Vec3 center = box.center();
  const double side = box.sizes().maxCoeff();
  if (!(side > 0) || !std::isfinite(side)) throw UserError(no_area);
  for (Corners& t : corners)
    for (Vec3& v : t) v = (v - center) / side;
  return {center, side};
}

}  // namespace

Surface make_surface(const Mesh& mesh, const std::vector<char>& flags, const char* model) {
  const std::string no_area =
      "The " + std::string(model) + " part has no area to compare: select faces that do not lie on one line.";
  std::vector<Corners> corners = emphasised(mesh, flags, model);
  const auto [center, side] = normalise_box(corners, no_area);

  // Integrals over a triangle with corners v: area/3 sum v, and area/12 (sum v v' + (sum v)(sum v)').
  double area = 0;
  Vec3 first = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const Corners& t : corners) {
    const double a = triangle_area(t);
    const Vec3 sum = t[0] + t[1] + t[2];
    area += a;
    first += a / 3 * sum;
    second += a / 12 * (sum * sum.transpose());
    for (const Vec3& v : t) second += a / 12 * (v * v.transpose());
  }
  if (!(area > 1e-9)) throw UserError(no_area);  // what rounding leaves of a line
  const Vec3 mean = first / area;
  const Eigen::Matrix3d covariance = second / area - mean * mean.transpose();
  const double rms = std::sqrt(covariance.trace());
  if (!(rms > 0)) throw UserError(no_area);

  Surface surface;
  surface.origin = center + side * mean;
  surface.size = side * rms;
  surface.covariance = covariance / (rms * rms);
  double total = 0;
  for (Corners& t : corners) {
    for (Vec3& v : t) v = (v - mean) / rms;
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const double twice = normal.norm();
    if (!(twice > 1e-14)) continue;
    total += twice / 2;
    surface.triangles.push_back(t);
    surface.normals.push_back(normal / twice);
    surface.area_up_to.push_back(total);
  }
  if (surface.triangles.empty()) throw UserError(no_area);
  return surface;
}

std::vector<Sample> sample_surface(const Surface& surface, int count) {
  // A Kronecker sequence: multiples of the powers of 1/g, g the root of g^4 = g + 1.
  const double step[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  std::vector<Sample> samples(count);
  for (int k = 0; k < count; ++k) {
    double u[3];
    for (int d = 0; d < 3; ++d) u[d] = 0.5 + step[d] * (k + 1), u[d] -= std::floor(u[d]);
    const auto at = std::upper_bound(surface.area_up_to.begin(), surface.area_up_to.end() - 1, u[0] * surface.area());
    const auto f = at - surface.area_up_to.begin();
    const Corners& t = surface.triangles[f];
    const double root = std::sqrt(u[1]);  // uniform over the triangle
    samples[k].point = (1 - root) * t[0] + root * (1 - u[2]) * t[1] + root * u[2] * t[2];
    samples[k].normal = surface.normals[f];
  }
  return samples;
}

Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);  // ascending
  Eigen::Matrix3d axes = solver.eigenvectors().rowwise().reverse();
  if (axes.determinant() < 0) axes.col(2) *= -1;
  return axes;
}

}  // namespace parts::spatial
