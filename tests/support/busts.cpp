// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/busts.h"

#include <algorithm>
#include <cmath>

#include "parts/mesh/attributes.h"
#include "support/bust_field.h"
#include "support/remesh.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

constexpr double kBase = BustField::kBase;
constexpr double kNeck = -0.5;  // above it the texture is the head's, below the body's
constexpr double kHeadShare = 0.8;

/// The length that edges should have about a point.
double length_at(const Vec3& p) {
  const double from_face = (Vec3(1.1 * p.x(), p.y() + 0.07, p.z() - 0.45)).norm();
  const double from_ear = (Vec3(std::abs(p.x()) - 0.37, p.y(), p.z() + 0.06)).norm();
  return std::clamp(0.019 + 0.045 * std::max(0.0, std::min(from_face - 0.2, from_ear - 0.1)), 0.019, 0.045);
}

/// Marching wants even cells, a bust finer ones at the face: the field is
/// marched in coordinates that are squeezed towards the shoulders.
Vec3 spread(const Vec3& q) {
  const auto wide = [](double t, double from) {
    const double e = std::max(0.0, std::abs(t) - from);
    return t < 0 ? t - 1.6 * e * e - 0.4 * e : t + 1.6 * e * e + 0.4 * e;
  };
  return {wide(q.x(), 0.36), q.y() < -0.4 ? wide(q.y() + 0.4, 0) - 0.4 : q.y(),
          q.z() < -0.1 ? wide(q.z() + 0.1, 0) - 0.1 : q.z()};
}

Eigen::Vector2d head_uv(const Vec3& p) {
  const Vec3 d = p - Vec3(0, 0.02, 0);
  const double around = std::atan2(d.x(), d.z()) / (2 * M_PI) + 0.5;  // 0.5 = front
  const double up = std::atan2(d.y(), std::hypot(d.x(), d.z())) / M_PI + 0.5;
  return {around, up};
}
Eigen::Vector2d body_uv(const Vec3& p) {
  return {std::atan2(p.x(), p.z() + 0.15) / (2 * M_PI) + 0.5, std::clamp((p.y() - kBase) / (kNeck - kBase), 0.0, 1.0)};
}

/// The head above, the body below; both a little wider than once around, so
/// that faces across the seam at the back need not wrap.
Wedges wedges_of(const Mesh& mesh, int face) {
  const double middle = (mesh.corner(face, 0).y() + mesh.corner(face, 1).y() + mesh.corner(face, 2).y()) / 3;
  const bool head = middle > kNeck;
  std::array<Eigen::Vector2d, 3> uv;
  double most = 0;
  for (int k = 0; k < 3; ++k) {
    uv[k] = head ? head_uv(mesh.corner(face, k)) : body_uv(mesh.corner(face, k));
    most = std::max(most, uv[k].x());
  }
  Wedges w;
  w.texture = 0;
  for (int k = 0; k < 3; ++k) {
    if (most - uv[k].x() > 0.5) uv[k].x() = std::min(uv[k].x() + 1, 1.1);  // less at the poles
    const double u = 0.02 + 0.96 * uv[k].x() / 1.1;
    const double v =
        head ? 1 - kHeadShare + 0.01 + (kHeadShare - 0.02) * uv[k].y() : 0.01 + (1 - kHeadShare - 0.02) * uv[k].y();
    w.uv[k] = Eigen::Vector2d(u, v).cast<float>();
  }
  return w;
}

}  // namespace

BustShape random_bust(unsigned seed) {
  Random random(seed * 2654435761u + 1);
  BustShape b;
  const auto vary = [&](double& value, double share) { value *= random.uniform(1 - share, 1 + share); };
  const auto shift = [&](double& value, double by) { value += random.uniform(-by, by); };
  vary(b.head_width, 0.09), vary(b.head_length, 0.07), vary(b.head_height, 0.07);
  vary(b.jaw_width, 0.12), shift(b.jaw_drop, 0.03), vary(b.chin, 0.22), shift(b.chin_forward, 0.03);
  vary(b.cheek, 0.2), shift(b.cheek_height, 0.025);
  vary(b.brow, 0.3), shift(b.brow_height, 0.015);
  vary(b.eye_distance, 0.08), vary(b.eye_size, 0.08), vary(b.eye_depth, 0.25);
  vary(b.nose_length, 0.18), vary(b.nose_forward, 0.35), vary(b.nose_width, 0.3), vary(b.nose_tip, 0.22);
  vary(b.nose_bridge, 0.3), shift(b.nose_tip_drop, 0.025);
  vary(b.mouth_width, 0.2), vary(b.lip, 0.3), shift(b.mouth_height, 0.02);
  vary(b.ear_size, 0.18), shift(b.ear_out, 0.25);
  vary(b.neck, 0.12), vary(b.shoulder_width, 0.14), shift(b.shoulder_drop, 0.05);
  const double tan = random.uniform(0.45, 1.05), warm = random.uniform(-0.05, 0.05);
  b.skin = Eigen::Vector3d(226 * (0.35 + 0.62 * tan), 180 * tan, 152 * (tan - warm) * 0.98);
  b.lips = 0.55 * b.skin + 0.45 * Eigen::Vector3d(176, 50, 60);
  const Eigen::Vector3d hairs[] = {{40, 30, 26},    {78, 52, 36},    {128, 88, 50},
                                   {196, 164, 110}, {150, 150, 152}, {120, 58, 34}};
  const Eigen::Vector3d irises[] = {{80, 52, 34}, {70, 96, 120}, {76, 104, 70}, {52, 38, 30}};
  b.hair = hairs[random.below(6)], b.iris = irises[random.below(4)];
  b.shirt = Eigen::Vector3d(random.uniform(50, 190), random.uniform(50, 190), random.uniform(50, 190));
  shift(b.hair_line, 0.05);
  b.seed = seed;
  return b;
}

Mesh bust_mesh(const BustShape& shape, const std::string& texture, int cells) {
  const BustField field(shape);
  const Box box(Vec3(-0.75, -0.94, -0.58), Vec3(0.75, 0.62, 0.72));
  Mesh mesh = isosurface([&](const Vec3& q) { return field(spread(q)); }, box, cells);
  for (Vec3& v : mesh.vertices) {
    v = spread(v);
    for (int i = 0; i < 4; ++i) {
      const Vec3 g = gradient(field, v);
      if (g.squaredNorm() > 0.04) v -= std::clamp(field(v) / g.squaredNorm(), -0.004, 0.004) * g;
    }
  }
  mesh = simplified(mesh, field, length_at);
  mesh.textures = {texture};
  for (int f = 0; f < mesh.face_count(); ++f) mesh.wedges.push_back(wedges_of(mesh, f));
  mesh::update_normals(mesh);
  return mesh;
}

BustLandmarks bust_landmarks(const BustShape& shape) {
  const BustField field(shape);
  return {field.hit(field.nose_end(), Vec3(0, -0.15, 1).normalized()), field.hit(Vec3(0, 0.1, -0.05), Vec3::UnitY()),
          field.hit(Vec3(0, field.chin_y(), 0.2), Vec3(0, -0.5, 1).normalized())};
}

Mesh without_ball(const Mesh& mesh, const Vec3& center, double radius) {
  return mesh::take_faces(mesh, faces_where(mesh, [&](const Vec3& c) { return (c - center).norm() > radius; }));
}

Mesh gouged(const Mesh& mesh, const Vec3& center, double radius, double depth, unsigned seed,
            std::vector<char>* faces) {
  Mesh damaged = mesh;
  mesh::update_normals(damaged);
  const std::vector<Eigen::Vector3f> normals = damaged.vertex_normal;
  Random random(seed);
  const Vec3 along = random.direction();
  std::vector<char> touched(mesh.vertices.size(), 0);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 d = (mesh.vertices[v] - center) / radius;
    if (d.norm() >= 1) continue;
    const double fall = std::pow(1 - d.squaredNorm(), 2), grooves = 0.6 + 0.4 * std::sin(9 * d.dot(along));
    damaged.vertices[v] -= depth * fall * (grooves + random.uniform(-0.25, 0.25)) * normals[v].cast<double>();
    touched[v] = 1;
  }
  if (mesh.vertex_normal.empty())
    damaged.vertex_normal.clear();
  else
    mesh::update_normals(damaged);
  if (faces) {
    faces->assign(mesh.faces.size(), 0);
    for (int f = 0; f < mesh.face_count(); ++f)
      for (int v : mesh.faces[f]) (*faces)[f] |= touched[v];
  }
  return damaged;
}

}  // namespace parts::test
