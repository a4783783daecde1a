// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/split_faces.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>
#include <unordered_map>

#include "parts/cut/face_triangulation.h"
#include "parts/mesh/attributes.h"

namespace parts::cut {
namespace {

std::uint64_t edge_key(int a, int b) {
  return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

/// Where a point of an edge is on the triangulations' grid, from the lower vertex.
std::int64_t grid_place(double share) {
  constexpr std::int64_t unit = FaceTriangulation::kUnit;
  return std::clamp<std::int64_t>(std::llround(std::clamp(share, 0.0, 1.0) * double(unit)), 1, unit - 1);
}

struct OnEdge {
  std::int64_t at;
  int vertex;
};

class Splitter {
 public:
  Splitter(const Mesh& mesh, const std::vector<SplitPoint>& points, const std::vector<char>& used,
           const std::vector<SplitSegment>& segments)
      : points_(points) {
    out.mesh = mesh;
    out.source.resize(mesh.faces.size());
    std::iota(out.source.begin(), out.source.end(), 0);
    out.vertex_of.assign(points.size(), -1);
    dead_.assign(mesh.faces.size(), 0);
    split_edges(used);
    for (int p = 0; p < int(points.size()); ++p)
      if (used[p] && points[p].face >= 0) inside_[points[p].face].push_back(p);
    for (const SplitSegment& s : segments) lines_[s.face].push_back(s.ends);
  }

  void run() {
    std::vector<char> at_split_edge(out.mesh.vertices.size(), 0);
    for (const auto& [key, list] : on_edge_) at_split_edge[key >> 32] = at_split_edge[std::uint32_t(key)] = 1;
    const int faces = out.mesh.face_count();
    for (int f = 0; f < faces; ++f) {
      const Triangle t = out.mesh.faces[f];
      std::array<const std::vector<OnEdge>*, 3> side{};
      for (int k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        if (!at_split_edge[a] || !at_split_edge[b]) continue;
        if (const auto it = on_edge_.find(edge_key(a, b)); it != on_edge_.end()) side[k] = &it->second;
      }
      const auto inside = inside_.find(f);
      if (side[0] || side[1] || side[2] || inside != inside_.end())
        split(f, side, inside == inside_.end() ? std::vector<int>{} : inside->second);
    }
    drop_split_faces();
  }

  SplitMesh out;

 private:
  void split_edges(const std::vector<char>& used) {
    std::vector<int> order;
    for (int p = 0; p < int(points_.size()); ++p)
      if (used[p] && points_[p].vertex >= 0)
        out.vertex_of[p] = points_[p].vertex;
      else if (used[p] && points_[p].face < 0)
        order.push_back(p);
    const auto place = [&](int p) {
      return std::tuple(points_[p].edge[0], points_[p].edge[1], grid_place(points_[p].share), p);
    };
    std::sort(order.begin(), order.end(), [&](int p, int q) { return place(p) < place(q); });
    for (int p : order) {
      const SplitPoint& point = points_[p];
      std::vector<OnEdge>& list = on_edge_[edge_key(point.edge[0], point.edge[1])];
      const std::int64_t at = grid_place(point.share);
      if (list.empty() || list.back().at != at) {
        const int v = mesh::add_vertex_between(out.mesh, point.edge[0], point.edge[1], point.share);
        out.mesh.vertices[v] = point.position;
        list.push_back({at, v});
      }
      out.vertex_of[p] = list.back().vertex;
    }
  }

  /// Replaces a face by its triangulation.
  void split(int f, const std::array<const std::vector<OnEdge>*, 3>& side, const std::vector<int>& inside) {
    const Triangle t = out.mesh.faces[f];
    FaceTriangulation plane;
    std::vector<int> vertex(t.begin(), t.end());  // of the mesh, per vertex of the triangulation
    const auto name = [&](int local, int v) {
      if (local < int(vertex.size())) return;  // an older one
      vertex.resize(local + 1, -1), vertex[local] = v;
    };
    std::unordered_map<int, int> local_of;  // per vertex of the mesh
    for (int k = 0; k < 3; ++k) {
      local_of[t[k]] = k;
      if (!side[k]) continue;
      const bool forth = t[k] < t[(k + 1) % 3];
      for (const OnEdge& p : *side[k]) {
        const int local = plane.add_on_side(k, forth ? p.at : FaceTriangulation::kUnit - p.at);
        name(local, p.vertex), local_of[p.vertex] = local;
      }
    }
    for (int p : inside) {
      const int local = plane.add_inside(points_[p].barycentric);
      if (local == int(vertex.size())) {
        name(local, mesh::add_vertex_within(out.mesh, f, points_[p].barycentric));
        out.mesh.vertices[vertex[local]] = points_[p].position;
      }
      out.vertex_of[p] = vertex[local], local_of[vertex[local]] = local;
    }
    if (const auto lines = lines_.find(f); lines != lines_.end())
      for (const auto& [p, q] : lines->second) {
        const auto u = local_of.find(out.vertex_of[p]), v = local_of.find(out.vertex_of[q]);
        if (u != local_of.end() && v != local_of.end()) plane.constrain(u->second, v->second);
      }
    plane.improve({out.mesh.vertices[t[0]], out.mesh.vertices[t[1]], out.mesh.vertices[t[2]]});
    for (int local = int(vertex.size()); local < plane.vertices(); ++local)  // where lines cross
      vertex.push_back(mesh::add_vertex_within(out.mesh, f, plane.barycentric(local)));
    for (const Triangle& n : plane.triangles()) {
      mesh::add_face_within(out.mesh, f, {vertex[n[0]], vertex[n[1]], vertex[n[2]]},
                            {plane.barycentric(n[0]), plane.barycentric(n[1]), plane.barycentric(n[2])});
      out.source.push_back(f), dead_.push_back(0);
    }
    dead_[f] = 1;
  }

  /// As take_faces(), but every vertex stays and keeps its number.
  void drop_split_faces() {
    const auto compact = [&](auto& array) {
      if (array.empty()) return;
      std::size_t to = 0;
      for (std::size_t f = 0; f < dead_.size(); ++f)
        if (!dead_[f]) array[to++] = array[f];
      array.resize(to);
    };
    Mesh& m = out.mesh;
    compact(m.faces), compact(m.face_color), compact(m.face_quality), compact(m.wedges), compact(m.face_selected);
    compact(out.source);
  }

  const std::vector<SplitPoint>& points_;
  std::unordered_map<std::uint64_t, std::vector<OnEdge>> on_edge_;
  std::unordered_map<int, std::vector<int>> inside_;                ///< per face: points
  std::unordered_map<int, std::vector<std::array<int, 2>>> lines_;  ///< per face: ends of segments
  std::vector<char> dead_;
};

}  // namespace

SplitMesh split_faces(const Mesh& mesh, const std::vector<SplitPoint>& points, const std::vector<char>& used,
                      const std::vector<SplitSegment>& segments) {
  Splitter s(mesh, points, used, segments);
  s.run();
  return std::move(s.out);
}

namespace {

/// Bisects one face until its parts are small.
class Bisector {
 public:
  Bisector(const Mesh& mesh, int face, std::vector<SplitPoint>& points,
           std::set<std::tuple<int, int, double>>& on_edges)
      : mesh_(mesh), face_(face), points_(points), on_edges_(on_edges) {}

  void run(const std::vector<char>& still, double longest, const std::function<bool(const Vec3&, double)>& near) {
    std::vector<std::array<Vec3, 3>> open{{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}};
    while (!open.empty()) {
      const std::array<Vec3, 3> part = open.back();
      open.pop_back();
      int k = 0;
      double length = 0;
      for (int j = 0; j < 3; ++j)
        if (const double l = (place(part[j]) - place(part[(j + 1) % 3])).norm(); l > length) length = l, k = j;
      const Vec3 &from = part[k], &to = part[(k + 1) % 3], middle = 0.5 * (from + to);
      if (!(length > longest) || !near(place(middle), 0.5 * length)) continue;
      if (!add(from, to, middle, still)) continue;
      open.push_back({from, middle, part[(k + 2) % 3]});
      open.push_back({middle, to, part[(k + 2) % 3]});
    }
  }

 private:
  Vec3 place(const Vec3& l) const {
    return l[0] * mesh_.corner(face_, 0) + l[1] * mesh_.corner(face_, 1) + l[2] * mesh_.corner(face_, 2);
  }
  /// @return false: on an edge that stays whole
  bool add(const Vec3& from, const Vec3& to, const Vec3& middle, const std::vector<char>& still) {
    for (int k = 0; k < 3; ++k) {
      if (from[k] != 0 || to[k] != 0) continue;
      int i = (k + 1) % 3, j = (k + 2) % 3;
      if (mesh_.faces[face_][i] > mesh_.faces[face_][j]) std::swap(i, j);
      const int low = mesh_.faces[face_][i], high = mesh_.faces[face_][j];
      if (still[low] && still[high]) return false;
      if (on_edges_.insert({low, high, middle[j]}).second)
        points_.push_back(SplitPoint::on_edge(
            mesh_.vertices[low] + middle[j] * (mesh_.vertices[high] - mesh_.vertices[low]), low, high, middle[j]));
      return true;
    }
    if (inside_.insert({middle[1], middle[2]}).second)
      points_.push_back(SplitPoint::in_face(place(middle), face_, middle));
    return true;
  }

  const Mesh& mesh_;
  const int face_;
  std::vector<SplitPoint>& points_;
  std::set<std::tuple<int, int, double>>& on_edges_;
  std::set<std::array<double, 2>> inside_;
};

}  // namespace

void add_even_points(const Mesh& mesh, const std::vector<char>& faces, const std::vector<char>& still, double longest,
                     const std::function<bool(const Vec3& place, double distance)>& near,
                     std::vector<SplitPoint>& points) {
  std::set<std::tuple<int, int, double>> on_edges;
  for (int f = 0; f < mesh.face_count(); ++f)
    if (faces[f]) Bisector(mesh, f, points, on_edges).run(still, longest, near);
}

}  // namespace parts::cut
