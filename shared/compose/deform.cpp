// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/deform.h"

#include "parts/mesh/attributes.h"

namespace parts::compose {
namespace {

/// The share t (0..1] of the way to the pose.
Eigen::Affine3d transform(const RigidPose& pose, double t) {
  const Vec3 axis = pose.axis.normalized();
  Eigen::Affine3d m = Eigen::Affine3d::Identity();
  m.translate(pose.pivot + t * pose.translation);
  m.rotate(Eigen::AngleAxisd(t * pose.angle * M_PI / 180, axis));
  m.scale(std::pow(pose.scale, t));
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
  if (pose.mirror) mirror -= 2 * axis * axis.transpose();
  m.linear() = m.linear() * mirror;
  m.translate(-pose.pivot);
  return m;
}

Mesh posed(const Mesh& mesh, const Eigen::Affine3d& m) {
  Mesh out = mesh;
  for (Vec3& v : out.vertices) v = m * v;
  const Eigen::Matrix3d normal = m.linear().inverse().transpose();
  for (Eigen::Vector3f& n : out.vertex_normal) n = (normal * n.cast<double>()).normalized().cast<float>();
  if (m.linear().determinant() < 0) {
    for (Triangle& f : out.faces) std::swap(f[1], f[2]);
    for (Wedges& w : out.wedges) std::swap(w.uv[1], w.uv[2]);
  }
  return out;
}

void check(const RigidPose& pose, int frames) {
  if (!pose.pivot.allFinite() || !pose.translation.allFinite() || !std::isfinite(pose.angle))
    throw UserError("The pose is not finite; give Pivot, Translation and Angle as plain numbers.");
  if (!pose.axis.allFinite() || !(pose.axis.norm() > 0))
    throw UserError("The axis has no direction; give a vector that is not zero.");
  if (!(pose.scale > 0) || !std::isfinite(pose.scale))
    throw UserError("The scale must be a positive number; use Mirror to turn the part over.");
  if (frames < 1) throw UserError("Frames must be 1 or more; 1 gives the final pose.");
}

}  // namespace

std::vector<ComposeResult> deform(const Mesh& mesh, const std::vector<char>& fixed, const std::vector<char>& moving,
                                  const RigidPose& pose, int frames, const ComposeOptions& options,
                                  Progress& progress) {
  check(pose, frames);
  std::vector<ComposeResult> results;
  for (int frame = 0; frame < frames; ++frame) {
    const double t = frames == 1 ? 1.0 : double(frame) / (frames - 1);
    if (t == 0) {
      ComposeResult rest;
      rest.composed = mesh;
      rest.face_from_b.assign(mesh.faces.size(), 0);
      results.push_back(std::move(rest));
      continue;
    }
    Progress share = progress.part(100 * frame / frames, 100 * (frame + 1) / frames);
    results.push_back(compose({mesh, fixed, "the fixed part"},
                              {posed(mesh, transform(pose, t)), moving, "the moving part"}, options, share));
    results.back().clipped_a = {}, results.back().clipped_b = {};  // a copy a frame is too much
  }
  return results;
}

}  // namespace parts::compose
