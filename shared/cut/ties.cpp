// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/ties.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <unordered_set>

namespace parts::cut {

std::vector<int> points_at(const WorkMesh& w, const CrossingCurve& curve) {
  std::vector<int> point(w.mesh.vertices.size(), -1);
  for (int p = int(curve.points.size()); p-- > 0;)
    if (w.vertex_of[p] >= 0) point[w.vertex_of[p]] = p;
  return point;
}

void find_twins(MeshProblem& problem, const CrossingCurve& curve) {
  std::map<Triangle, int> face_at;
  const auto key = [&](int x, int f, const std::vector<int>& point) {
    Triangle t = problem.side[x].mesh.faces[f];
    for (int& v : t) v = point[v];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  const std::vector<int> of_a = points_at(problem.side[0], curve), of_b = points_at(problem.side[1], curve);
  WorkMesh &a = problem.side[0], &b = problem.side[1];
  for (int f = 0; f < a.mesh.face_count(); ++f)
    if (const Triangle t = key(0, f, of_a); t[0] >= 0) face_at[t] = f;
  for (int g = 0; g < b.mesh.face_count() && !face_at.empty(); ++g)
    if (const Triangle t = key(1, g, of_b); t[0] >= 0)
      if (const auto f = face_at.find(t); f != face_at.end()) b.twin[g] = f->second, a.twin[f->second] = g;
}

namespace {

/// Goes over the segments, and ties what parts or crosses there.
class Tier {
 public:
  Tier(MeshProblem& problem, const CrossingCurve& curve, const std::array<const Model*, 2>& model,
       const spatial::FaceTree (&tree)[2])
      : problem_(problem), curve_(curve), model_(model), tree_(tree) {}

  void operator()() {
    std::vector<char> at_curve[2];
    for (int x : {0, 1}) {
      at_curve[x].assign(problem_.side[x].mesh.vertices.size(), 0);
      for (const CrossingSegment& s : curve_.segments)
        for (int end : s.ends)
          if (const int v = problem_.side[x].vertex_of[end]; v >= 0) at_curve[x][v] = 1;
    }
    std::unordered_map<std::uint64_t, int> edge_at[2];
    for (int x : {0, 1})
      for (std::size_t e = 0; e < problem_.side[x].edges.size(); ++e)
        if (const WorkMesh::Edge& edge = problem_.side[x].edges[e]; at_curve[x][edge.low] && at_curve[x][edge.high])
          edge_at[x][edge_key(edge.low, edge.high)] = int(e);
    std::unordered_set<std::uint64_t> tied;
    for (int s = 0; s < int(curve_.segments.size()); ++s) {
      WorkMesh::Edge* edge[2];
      bool good = true;
      for (int x : {0, 1}) {
        WorkMesh& w = problem_.side[x];
        const int p = w.vertex_of[curve_.segments[s].ends[0]], q = w.vertex_of[curve_.segments[s].ends[1]];
        const auto it = edge_at[x].find(edge_key(p, q));
        good = good && p != q && it != edge_at[x].end();
        edge[x] = good ? &w.edges[it->second] : nullptr;
        good = good && edge[x]->end_face - edge[x]->first_face == 2;
      }
      if (good && tied.insert(edge_key(edge[0]->low, edge[0]->high)).second) tie(s, *edge[0], *edge[1]);
    }
  }

 private:
  const Mesh& mesh(int x) const { return model_[x]->prepared.mesh; }

  /// An edge's two faces: the one whose side runs as the edge does, and the other.
  static std::array<int, 2> forth_and_back(const WorkMesh& w, const WorkMesh::Edge& e, int from) {
    std::array<int, 2> face{w.edge_faces[e.first_face], w.edge_faces[e.first_face + 1]};
    const auto forth = [&](int f) {
      const Triangle& t = w.mesh.faces[f];
      for (int k = 0; k < 3; ++k)
        if (t[k] == from) return t[(k + 1) % 3] == e.low || t[(k + 1) % 3] == e.high;
      return false;
    };
    if (!forth(face[0])) std::swap(face[0], face[1]);
    return face;
  }

  /// Ties the faces at an edge that both models have, if they part there, or cross.
  void tie(int s, WorkMesh::Edge& edge_a, WorkMesh::Edge& edge_b) {
    constexpr double kFlat = 1e-4;   // radians: faces at a smaller angle lie on each other
    constexpr double kClear = 0.06;  // the least 1 - cosine of an angle that is no accident
    const CrossingSegment& segment = curve_.segments[s];
    const Vec3 from = curve_.points[segment.ends[0]].position(),
               along = curve_.points[segment.ends[1]].position() - from;
    const WorkMesh &a = problem_.side[0], &b = problem_.side[1];
    const auto [a_forth, a_back] = forth_and_back(a, edge_a, a.vertex_of[segment.ends[0]]);
    const auto [b_forth, b_back] = forth_and_back(b, edge_b, b.vertex_of[segment.ends[0]]);
    // Angles around the edge, from A's first face on. Seen against it, the outside lies to the left of a
    // face that runs forth, the inside to that of one that runs back.
    const auto inwards = [&](const WorkMesh& w, const WorkMesh::Edge& e, int f) {
      Vec3 third = from;
      for (int v : w.mesh.faces[f])
        if (v != e.low && v != e.high) third = w.mesh.vertices[v];
      return Vec3(third - from - along * ((third - from).dot(along) / along.squaredNorm()));
    };
    const Vec3 right = inwards(a, edge_a, a_forth), up = along.normalized().cross(right);
    const auto angle = [&](const WorkMesh& w, const WorkMesh::Edge& e, int f) {
      const Vec3 d = inwards(w, e, f);
      const double t = std::atan2(d.dot(up), d.dot(right));
      return t < 0 ? t + 2 * M_PI : t;
    };
    const double turn_a = angle(a, edge_a, a_back), forth = angle(b, edge_b, b_forth), back = angle(b, edge_b, b_back);
    const auto flat = [](double t) { return std::min(std::abs(t), 2 * M_PI - std::abs(t)) < kFlat; };
    const bool same_forth = flat(forth), same_back = flat(back - turn_a);
    const auto add = [&](int a_outside, int a_inside, int b_outside, int b_inside, double turn, bool clear) {
      Tie t{s, a_outside, a_inside, b_outside, b_inside, along.norm(), turn, clear, false};
      edge_a.turn = edge_b.turn = std::max(0.0, turn);
      const Vec3 middle = from + 0.5 * along;
      t.hidden = inside_itself(0, segment.face_a, middle, mesh(0).normal(segment.face_a)) ||
                 inside_itself(1, segment.face_b, middle, mesh(1).normal(segment.face_b));
      problem_.ties.push_back(t);
    };
    const auto turn_between = [&](int f, int g) { return 1 - a.normal[f].dot(b.normal[g]); };
    if (same_forth && same_back) return;
    if (same_forth || same_back) {
      const int a_one = same_forth ? a_forth : a_back, a_other = same_forth ? a_back : a_forth;
      const int b_one = same_forth ? b_forth : b_back, b_other = same_forth ? b_back : b_forth;
      const double parting = turn_a - (same_forth ? back : forth);
      add(a_other, a_one, b_one, b_other, std::min(turn_between(a_other, b_one), turn_between(a_one, b_other)),
          1 - std::cos(same_forth ? parting : forth) >= kClear);
      return;
    }
    const bool contact_forth = flat(back), contact_back = flat(forth - turn_a);
    if (contact_forth || contact_back) {
      // Beyond the contact the other must lie outside, or all is inside.
      if (contact_forth && contact_back) return;
      if (contact_forth ? forth < turn_a : back < turn_a)
        add(contact_forth ? a_back : a_forth, contact_forth ? a_forth : a_back, contact_forth ? b_forth : b_back,
            contact_forth ? b_back : b_forth,
            contact_forth ? turn_between(a_back, b_forth) : turn_between(a_forth, b_back), true);
      return;
    }
    const bool forth_outside = forth < turn_a, back_outside = back < turn_a;
    if (forth_outside == back_outside) return;  // they touch
    const double to_back = back > forth ? back - forth : back - forth + 2 * M_PI, to_a = 2 * M_PI - forth;
    const bool a_forth_outside = to_a < to_back;
    const int a_outside = a_forth_outside ? a_forth : a_back, b_outside = forth_outside ? b_forth : b_back;
    const double turn = turn_between(a_outside, b_outside);
    add(a_outside, a_forth_outside ? a_back : a_forth, b_outside, forth_outside ? b_back : b_forth, turn,
        turn >= kClear);
  }

  /// Whether a point on a closed model lies inside another part of it.
  bool inside_itself(int x, int face, const Vec3& p, const Vec3& normal) const {
    const mesh::Prepared& m = model_[x]->prepared;
    const Vec3 aslant(1.3e-3, -2.1e-3, 0.7e-3);  // past edges that the normal would meet
    return m.closed[m.component[face]] &&
           tree_[x].winding(p, (normal + aslant).normalized(), 1e-5 * problem_.scale) != 0;
  }

  MeshProblem& problem_;
  const CrossingCurve& curve_;
  const std::array<const Model*, 2> model_;
  const spatial::FaceTree (&tree_)[2];
};

}  // namespace

void find_ties(MeshProblem& problem, const CrossingCurve& curve, const std::array<const Model*, 2>& model,
               const spatial::FaceTree (&tree)[2]) {
  Tier(problem, curve, model, tree)();
}

}  // namespace parts::cut
