// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/small_holes.h"

#include "parts/mesh/attributes.h"
#include "parts/mesh/pinches.h"
#include "parts/mesh/result_check.h"
#include "parts/spatial/face_tree.h"

namespace parts::mend {
namespace {

/// Triangles between the corners of a rim, or its middle: the corner past the last.
using Lid = std::vector<Triangle>;

/// The ways to close a rim of so many edges, in the order of preference; they run against it.
std::vector<Lid> lids(int n) {
  if (n == 3) return {{{2, 1, 0}}};
  std::vector<Lid> all(1);
  for (int k = 0; k < n; ++k) all[0].push_back({(k + 1) % n, k, n});
  for (int corner = 0; corner < n; ++corner) {
    Lid fan;
    for (int k = 1; k + 1 < n; ++k) fan.push_back({corner, (corner + k + 1) % n, (corner + k) % n});
    all.push_back(std::move(fan));
  }
  return all;
}

Vec3 middle_of(const Mesh& mesh, const mesh::Loop& rim) {
  Vec3 middle = Vec3::Zero();
  for (int v : rim) middle += mesh.vertices[v] / rim.size();
  return middle;
}

/// Closes the rims of a scan one by one.
class Closing {
 public:
  explicit Closing(const Scan& scan)
      : mesh_(scan.mesh()), own_faces_(mesh_.face_count()), tree_(mesh_), like_(mesh_.vertices.size(), -1) {
    for (int f = 0; f < own_faces_; ++f)
      for (int v : mesh_.faces[f]) like_[v] = f;
  }

  /// @return false: the rim stays
  bool close(const mesh::Loop& rim) {
    const Mesh around = neighbourhood(rim);
    const std::vector<mesh::SurfaceFigures> before{mesh::measure_surface(around, 1)};
    mesh::ResultRules rules;  // of what is cut out
    rules.may_part = rules.may_open = true;
    for (const Lid& lid : lids(rim.size())) {
      Mesh closed = around;
      const int first = closed.vertex_count();
      for (int v : rim) closed.vertices.push_back(mesh_.vertices[v]);
      closed.vertices.push_back(middle_of(mesh_, rim));
      for (const Triangle& t : lid) closed.faces.push_back({first + t[0], first + t[1], first + t[2]});
      if (!mesh::worse_than_inputs(mesh::measure_surface(closed, 1), before, rules).empty()) continue;
      add(rim, lid);
      return true;
    }
    return false;
  }

  Mesh take() { return std::move(mesh_); }

 private:
  /// The faces whose boxes touch the rim's, without attributes.
  Mesh neighbourhood(const mesh::Loop& rim) const {
    Box box;
    for (int v : rim) box.extend(mesh_.vertices[v]);
    Mesh whole_box;
    whole_box.vertices = {box.min(), box.max()};
    whole_box.faces = {{0, 1, 1}};
    Mesh out;
    const auto take = [&](int f) {
      const int first = out.vertex_count();
      for (int k = 0; k < 3; ++k) out.vertices.push_back(mesh_.corner(f, k));
      out.faces.push_back({first, first + 1, first + 2});
    };
    tree_.for_each_overlap(spatial::FaceTree(whole_box), 0, [&](int f, int) { take(f); });
    for (int f = own_faces_; f < mesh_.face_count(); ++f)  // earlier lids
      if (box.intersects(mesh_.face_box(f))) take(f);
    return out;
  }

  void add(const mesh::Loop& rim, const Lid& lid) {
    const int n = rim.size();
    int middle = -1;
    for (const Triangle& t : lid) {
      Triangle face;
      for (int k = 0; k < 3; ++k) {
        if (t[k] == n && middle < 0) {
          const Vec3 place = middle_of(mesh_, rim);
          middle = mesh::add_vertex_between(mesh_, rim.vertices[0], rim.vertices[std::size_t(n / 2)], 0.5);
          mesh_.vertices[std::size_t(middle)] = place;
        }
        face[k] = t[k] == n ? middle : rim.vertices[std::size_t(t[k])];
      }
      mesh::add_face_like(mesh_, like_[rim.vertices[std::size_t(t[1] % n)]], face);
    }
  }

  Mesh mesh_;
  int own_faces_;
  spatial::FaceTree tree_;
  std::vector<int> like_;  ///< per vertex: one of its faces
};

}  // namespace

bool is_small(const mesh::Loop& rim) {
  constexpr int kMostEdges = 6;
  return rim.size() <= kMostEdges;
}

SmallHoles close_small(const Scan& scan, const std::vector<mesh::Loop>& rims) {
  if (rims.empty()) return {scan, {}};
  Closing closing(scan);
  std::vector<char> closed;
  for (const mesh::Loop& rim : rims) closed.push_back(closing.close(rim));
  Mesh mesh = closing.take();
  std::vector<int> origin = scan.origin();
  origin.resize(mesh.faces.size(), kFromStitch);
  mesh::weld_steps(mesh, origin);
  return {Scan(std::move(mesh), std::move(origin)), std::move(closed)};
}

}  // namespace parts::mend
