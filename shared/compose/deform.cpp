// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/deform.h"

#include <chrono>

#include "parts/base/parallel.h"
#include "parts/compose/assemble.h"
#include "parts/compose/rigid_cut.h"
#include "parts/cut/seam_score.h"
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

void check(const RigidPose& pose, int frames) {
  if (!pose.pivot.allFinite() || !pose.translation.allFinite() || !std::isfinite(pose.angle))
    throw UserError("The pose is not finite; give Pivot, Translation and Angle as plain numbers.");
  if (!pose.axis.allFinite() || !(pose.axis.norm() > 0))
    throw UserError("The axis has no direction; give a vector that is not zero.");
  if (!(pose.scale > 0) || !std::isfinite(pose.scale))
    throw UserError("The scale must be a positive number; use Mirror to turn the part over.");
  if (frames < 1) throw UserError("Frames must be 1 or more; 1 gives the final pose.");
}

/// The shares of the way that the frames show; 0 = at rest.
std::vector<double> frame_shares(int frames) {
  if (frames == 1) return {1};
  std::vector<double> t;
  for (int frame = 0; frame < frames; ++frame) t.push_back(double(frame) / (frames - 1));
  return t;
}

ComposeResult at_rest(const Mesh& mesh) {
  ComposeResult rest;
  rest.composed = mesh;
  rest.face_from_b.assign(mesh.faces.size(), 0);
  return rest;
}

/// The longest way that a point of the seam makes while its share goes from 0 to 1.
double longest_way(const Mesh& mesh, const RigidCut& cut, const RigidPose& pose) {
  constexpr int kSteps = 8;
  double longest = 0;
  for (const auto& edge : cut.seam)
    for (int v : edge) {
      double way = 0;
      Vec3 before = mesh.vertices[v];
      for (int s = 1; s <= kSteps; ++s) {
        const Vec3 next = transform(pose, double(s) / kSteps) * mesh.vertices[v];
        way += (next - before).norm(), before = next;
      }
      longest = std::max(longest, way);
    }
  return longest;
}

double mean_edge(const RigidCut& cut) { return cut.seam.empty() ? 0 : cut.length / double(cut.seam.size()); }

/// The mesh itself with every vertex where its share of the pose takes it.
class BlendedFrames {
 public:
  BlendedFrames(const Mesh& mesh, const RigidPose& pose, std::vector<double> share)
      : mesh_(mesh), pose_(pose), share_(std::move(share)) {}

  Mesh frame(double t, int threads) const {
    Mesh out = mesh_;
    parallel_for(out.vertex_count(), threads, [&](long begin, long end) {
      for (long v = begin; v < end; ++v) {
        if (share_[v] == 0) continue;
        const Eigen::Affine3d map = transform(pose_, t * share_[v]);
        out.vertices[v] = map * out.vertices[v];
        if (!out.vertex_normal.empty())
          out.vertex_normal[v] = (map.linear().cast<float>() * out.vertex_normal[v]).normalized();
      }
    });
    if (!out.vertex_normal.empty()) mend_normals(out);
    return out;
  }

 private:
  /// Where the surface bends, the normals are its own.
  void mend_normals(Mesh& out) const {
    std::vector<char> bent(out.vertices.size(), 0);
    for (const Triangle& f : out.faces)
      if (share_[f[0]] != share_[f[1]] || share_[f[1]] != share_[f[2]])
        for (int v : f) bent[v] = 1;
    std::vector<Eigen::Vector3f> rigid = out.vertex_normal;
    mesh::update_normals(out);
    for (std::size_t v = 0; v < bent.size(); ++v)
      if (!bent[v]) out.vertex_normal[v] = rigid[v];
  }

  const Mesh& mesh_;
  const RigidPose& pose_;
  const std::vector<double> share_;
};

/// The resting part and the mirrored one, stitched at the cut: between a face
/// and its mirror image no share of a pose leads.
ComposeResult mirrored_frame(const Mesh& mesh, const std::vector<char>& fixed, const std::vector<char>& moving,
                             const RigidCut& cut, const Eigen::Affine3d& map, const ComposeOptions& options,
                             Progress& progress) {
  const cut::Model rest = cut::make_model({mesh, fixed}, "the fixed part");
  const cut::Model posed = cut::make_model({mesh::transformed(mesh, map), moving}, "the moving part");
  std::vector<char> rests(cut.moves.size());
  for (std::size_t f = 0; f < rests.size(); ++f) rests[f] = !cut.moves[f];
  const double edge = std::max(mean_edge(cut), 1e-9 * mesh.bounds().diagonal().norm());
  Assembly frame;
  assemble(rest, take_model_faces(rest, rests), posed, take_model_faces(posed, cut.moves),
           {edge, 3 * edge + 3 * cut.gap}, options, progress, frame);
  return std::move(frame.result);
}

/// One cut for all frames.
std::vector<ComposeResult> deform_one_mesh(const Mesh& mesh, const std::vector<char>& fixed,
                                           const std::vector<char>& moving, const RigidPose& pose, int frames,
                                           const ComposeOptions& options, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<double> shares = frame_shares(frames);
  std::vector<Eigen::Affine3d> poses;
  for (double t : shares)
    if (t > 0) poses.push_back(transform(pose, t));
  progress.stage("Finding the minimal cut", 0, 30);
  const RigidCut cut = cut_rigidly(mesh, fixed, moving, poses);
  const double cut_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  progress.stage("Bending", 30, 100);
  // Wide enough that the inner side of a bend does not fold: the share's
  // steepest slope is 3/4 over the distance.
  const double distance = options.smoothing.distance > 0
                              ? options.smoothing.distance
                              : std::max(1.2 * longest_way(mesh, cut, pose), 2 * mean_edge(cut));
  const BlendedFrames blended(mesh, pose,
                              pose.mirror ? std::vector<double>() : pose_shares(mesh, cut, fixed, moving, distance));
  std::vector<ComposeResult> results;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    progress.at(double(k) / double(shares.size()));
    if (shares[k] == 0) {
      results.push_back(at_rest(mesh));
    } else if (pose.mirror) {
      Progress silent;
      results.push_back(mirrored_frame(mesh, fixed, moving, cut, transform(pose, shares[k]), options, silent));
    } else {
      ComposeResult r;
      r.composed = blended.frame(shares[k], options.threads);
      r.face_from_b = cut.moves;
      r.report.seam_length = cut.length;
      results.push_back(std::move(r));
    }
    ComposeReport& report = results.back().report;
    report.cut_cost = cut.cost, report.cut_seconds = cut_seconds, report.scale = cut::rms_size(mesh);
    report.seam_gap = cut.gap;
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  progress.at(1.0);
  return results;
}

}  // namespace

std::vector<ComposeResult> deform(const Mesh& mesh, const std::vector<char>& fixed, const std::vector<char>& moving,
                                  const RigidPose& pose, int frames, const ComposeOptions& options,
                                  Progress& progress) {
  check(pose, frames);
  if (options.cut == cut::Cut::Mesh) return deform_one_mesh(mesh, fixed, moving, pose, frames, options, progress);
  std::vector<ComposeResult> results;
  for (const double t : frame_shares(frames)) {
    const int frame = int(results.size());
    if (t == 0) {
      results.push_back(at_rest(mesh));
      continue;
    }
    Progress share = progress.part(100 * frame / frames, 100 * (frame + 1) / frames);
    results.push_back(compose({mesh, fixed, "the fixed part"},
                              {mesh::transformed(mesh, transform(pose, t)), moving, "the moving part"}, options,
                              share));
    results.back().clipped_a = {}, results.back().clipped_b = {};  // a copy a frame is too much
  }
  return results;
}

}  // namespace parts::compose
