// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/compose/clip_border.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/edges.h"

namespace parts::compose {
namespace {

std::uint64_t edge_key(int a, int b) {
  return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

class BorderClipper {
 public:
  BorderClipper(const cut::MeshBorder& border, const std::vector<char>& keep)
      : border_(border),
        must_stay_(keep),
        mesh_(border.split.mesh),
        source_(border.split.source),
        live_(mesh_.faces.size(), 1),
        value_(border.value),
        same_(border.same),
        whole_vertices_(mesh_.vertex_count()) {
    mesh::for_each_mesh_edge(mesh::sorted_half_edges(mesh_), [&](auto first, auto last) {
      if (last - first == 1) own_border_.insert(edge_key(first->from, first->to));
    });
  }

  seam::Clipped run(double crumb) {
    const int faces = mesh_.face_count();
    for (int f = 0; f < faces; ++f) clip_face(f);
    std::vector<std::array<int, 2>> border = find_border();
    if (drop_crumbs(border, crumb)) border = find_border();
    seam::Clipped out;
    std::vector<int> old_vertex, old_face, number(mesh_.vertices.size(), -1);
    out.mesh = mesh::take_faces(mesh_, live_, &old_vertex, &old_face);
    for (int f : old_face) out.source_face.push_back(source_[f]);
    if (!same_.empty())
      for (int f : old_face) out.same.push_back(same_[f]);
    for (std::size_t v = 0; v < old_vertex.size(); ++v) number[old_vertex[v]] = int(v);
    out.cut_vertex.assign(old_vertex.size(), 0);
    for (const auto& [from, to] : border) {
      out.border.push_back({number[from], number[to]});
      out.cut_vertex[number[from]] = out.cut_vertex[number[to]] = 1;
    }
    return out;
  }

 private:
  struct Crossing {
    int vertex;
    double share;  ///< of the way from the lower vertex of its edge
  };

  /// Where the border crosses an edge.
  const Crossing& crossing(int i, int j) {
    constexpr double kMargin = 0.01;  // no face gets an edge of no length
    const auto [it, fresh] = crossing_.try_emplace(edge_key(i, j), Crossing{});
    if (fresh) {
      const int low = std::min(i, j), high = std::max(i, j);
      const double t = std::clamp(value_[low] / (value_[low] - value_[high]), kMargin, 1 - kMargin);
      it->second = {mesh::add_vertex_between(mesh_, low, high, t), t};
      edge_of_[it->second.vertex] = edge_key(low, high);
      value_.push_back(0);
    }
    return it->second;
  }

  /// Barycentric place of a crossing on a face's edge from corner k on.
  Vec3 place(const Triangle& t, int k, const Crossing& c) const {
    const double share = t[k] < t[(k + 1) % 3] ? c.share : 1 - c.share;
    return (1 - share) * Vec3::Unit(k) + share * Vec3::Unit((k + 1) % 3);
  }

  void add(int parent, const Triangle& v, const std::array<Vec3, 3>& at) {
    mesh::add_face_within(mesh_, parent, v, at);
    source_.push_back(source_[parent]), live_.push_back(1);
    if (!same_.empty()) same_.push_back(same_[parent]);
  }

  void clip_face(int f) {
    const Triangle t = mesh_.faces[f];
    int positive = 0, negative = 0;
    for (int v : t) positive += value_[v] > 0, negative += value_[v] < 0;
    if (!negative) {
      live_[f] = positive || border_.keep_level[f];
      return;
    }
    live_[f] = 0;
    if (!positive) return;
    // Corner a stands alone on its side; where another is zero, it is the kept one.
    const bool one = positive == 1;
    int k = 0;
    while (one ? value_[t[k]] <= 0 : value_[t[k]] >= 0) ++k;
    const int kb = (k + 1) % 3, kc = (k + 2) % 3, a = t[k], b = t[kb], c = t[kc];
    if (positive + negative == 2) {  // the border ends in a corner
      const bool at_b = value_[b] < 0;
      const Crossing x = at_b ? crossing(a, b) : crossing(c, a);
      const Vec3 at = at_b ? place(t, k, x) : place(t, kc, x);
      if (at_b)
        add(f, {a, x.vertex, c}, {Vec3::Unit(k), at, Vec3::Unit(kc)});
      else
        add(f, {a, b, x.vertex}, {Vec3::Unit(k), Vec3::Unit(kb), at});
      return;
    }
    const Crossing ab = crossing(a, b), ac = crossing(a, c);
    const Vec3 at_ab = place(t, k, ab), at_ac = place(t, kc, ac);
    const int p = ab.vertex, q = ac.vertex;
    if (one) {
      add(f, {a, p, q}, {Vec3::Unit(k), at_ab, at_ac});
    } else if ((mesh_.vertices[p] - mesh_.vertices[c]).squaredNorm() <
               (mesh_.vertices[q] - mesh_.vertices[b]).squaredNorm()) {
      add(f, {p, b, c}, {at_ab, Vec3::Unit(kb), Vec3::Unit(kc)});
      add(f, {p, c, q}, {at_ab, Vec3::Unit(kc), at_ac});
    } else {
      add(f, {p, b, q}, {at_ab, Vec3::Unit(kb), at_ac});
      add(f, {b, c, q}, {Vec3::Unit(kb), Vec3::Unit(kc), at_ac});
    }
  }

  bool on_own_border(int i, int j) const {
    if (i < whole_vertices_ && j < whole_vertices_) return own_border_.count(edge_key(i, j)) > 0;
    if (i < whole_vertices_) std::swap(i, j);
    const std::uint64_t edge = edge_of_.at(i);
    const bool part = j < whole_vertices_ ? int(edge >> 32) == j || int(std::uint32_t(edge)) == j : false;
    return part && own_border_.count(edge) > 0;
  }

  /// Half-edges of what is left that have no opposite, but for the model's own border.
  std::vector<std::array<int, 2>> find_border() const {
    Mesh left;
    left.vertices.resize(mesh_.vertices.size());
    // Far from the border nothing changed.
    std::vector<char> near(mesh_.vertices.size(), 0);
    for (int f = 0; f < mesh_.face_count(); ++f)
      if (!live_[f])
        for (int v : mesh_.faces[f]) near[v] = 1;
    for (int f = 0; f < mesh_.face_count(); ++f) {
      const Triangle& t = mesh_.faces[f];
      if (live_[f] && near[t[0]] + near[t[1]] + near[t[2]] + (t[0] >= whole_vertices_) + (t[1] >= whole_vertices_) +
                              (t[2] >= whole_vertices_) >=
                          1)
        left.faces.push_back(t);
    }
    std::unordered_set<std::uint64_t> dropped;  // edges that had a face more
    for (int f = 0; f < mesh_.face_count(); ++f)
      if (!live_[f])
        for (int k = 0; k < 3; ++k) dropped.insert(edge_key(mesh_.faces[f][k], mesh_.faces[f][(k + 1) % 3]));
    std::vector<std::array<int, 2>> border;
    mesh::for_each_mesh_edge(mesh::sorted_half_edges(left), [&](auto first, auto last) {
      if (last - first != 1 || on_own_border(first->from, first->to)) return;
      if (first->low() >= whole_vertices_ || first->high() >= whole_vertices_ ||
          dropped.count(edge_key(first->from, first->to)))
        border.push_back({first->from, first->to});
    });
    return border;
  }

  bool drop_crumbs(const std::vector<std::array<int, 2>>& border, double crumb) {
    DisjointSets pieces(mesh_.vertex_count());
    for (std::size_t f = 0; f < live_.size(); ++f)
      if (live_[f])
        for (int k : {1, 2}) pieces.unite(mesh_.faces[f][0], mesh_.faces[f][k]);
    std::unordered_map<int, Box> boxes;  // of pieces that the border bounds
    for (const auto& e : border) boxes[pieces.find(e[0])];
    for (std::size_t f = 0; f < live_.size(); ++f) {
      if (!live_[f]) continue;
      const auto piece = boxes.find(pieces.find(mesh_.faces[f][0]));
      if (piece == boxes.end()) continue;
      if (must_stay_[source_[f]])
        boxes.erase(piece);
      else
        piece->second.extend(mesh_.face_box(int(f)));
    }
    bool any = false;
    for (std::size_t f = 0; f < live_.size(); ++f) {
      if (!live_[f]) continue;
      const auto piece = boxes.find(pieces.find(mesh_.faces[f][0]));
      if (piece != boxes.end() && piece->second.sizes().norm() < crumb) live_[f] = 0, any = true;
    }
    return any;
  }

  const cut::MeshBorder& border_;
  const std::vector<char>& must_stay_;
  Mesh mesh_;
  std::vector<int> source_;
  std::vector<char> live_;
  std::vector<double> value_;
  std::vector<char> same_;
  const int whole_vertices_;
  std::unordered_map<std::uint64_t, Crossing> crossing_;
  std::unordered_map<int, std::uint64_t> edge_of_;  ///< per new vertex
  std::unordered_set<std::uint64_t> own_border_;
};

}  // namespace

seam::Clipped clip_border(const cut::MeshBorder& border, const std::vector<char>& keep, double crumb) {
  return BorderClipper(border, keep).run(crumb);
}

}  // namespace parts::compose
