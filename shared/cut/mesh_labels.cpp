// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/mesh_labels.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "parts/base/disjoint_sets.h"
#include "parts/cut/max_flow.h"

namespace parts::cut {
namespace {

// Prices, in lengths of S (lambda: SeamScore::kLambda).
constexpr double kKeepShare = 1e-3;  // of its area: what a face costs that goes with the other model
constexpr double kTie = 0.05;        // to break a tie, per length
constexpr double kHiddenTie = 0.01;  // and where it is hidden
constexpr double kOpposite = 0.3;    // to cut where what is nearest looks the other way, per length
constexpr double kCoupling = 0.5;    // of its area: to part a face from what could replace it
constexpr double kAgree = 0.2;       // the least cosine of what could replace it
constexpr double kLayers = 0.1;      // how near faces are that lie over each other, twice or not at all
constexpr double kFarthest = 0.4;    // the largest reach

/// What a face's label is worth beside its counterpart's: how far the two could
/// replace each other, 0..1.
double agreement(const WorkMesh& mine, const WorkMesh& other, int f) {
  const WorkMesh::Near& near = mine.face_near[f];
  if (near.face < 0 || near.beside) return 0;
  return std::max(0.0, (mine.normal[f].dot(other.normal[near.face]) - kAgree) / (1 - kAgree));
}

/// One minimal cut: the graph for a reach.
class LabelGraph {
 public:
  /// @param curve_only  the models can part only where they cross
  LabelGraph(const MeshProblem& p, double reach, bool curve_only)
      : p_(p),
        reach_(reach),
        curve_only_(curve_only),
        faces_a_(p.side[0].mesh.face_count()),
        sets_(faces_a_ + p.side[1].mesh.face_count()) {
    unite_twins();
    for (int x : {0, 1}) add_edges(x);
    for (int x : {0, 1})
      if (!curve_only) add_couplings(x);
    add_ties();
  }

  bool solve(MeshLabels& labels);

 private:
  struct Arc {
    int from, to;
    std::int64_t capacity;
  };

  int node(int side, int face) const { return side ? faces_a_ + face : face; }
  std::int64_t capacity(double cost) const {
    const double unit = 1e9 / (p_.scale * p_.scale);
    return std::max<std::int64_t>(1, std::int64_t(std::min(std::round(cost * unit), 1e15)));
  }
  double cost(const WorkMesh& mine, const WorkMesh& other, const WorkMesh::Edge& e) const;
  void unite_twins();
  void add_edges(int x);
  void add_couplings(int x);
  void add_ties();

  const MeshProblem& p_;
  const double reach_;
  const bool curve_only_;
  const int faces_a_;
  DisjointSets sets_;  ///< of faces that nothing can part
  std::vector<Arc> arcs_;
};

/// What it costs to cut an edge, negative where that is impossible. The other
/// model pays the other half, unless nothing forces it to be cut too.
double LabelGraph::cost(const WorkMesh& mine, const WorkMesh& other, const WorkMesh::Edge& e) const {
  const double lambda = SeamScore::kLambda * p_.scale, length = mine.length(e);
  if (e.crossing()) return 0.5 * length * lambda * (1 + e.turn);
  if (curve_only_) return -1;
  const WorkMesh::Near &low = mine.vertex_near[e.low], &high = mine.vertex_near[e.high];
  if (!(low.distance < reach_) || !(high.distance < reach_)) return -1;
  if (low.opposite || high.opposite) return kOpposite * length * p_.scale;
  // Beside the other's own border it is not cut at all: that is no free exit.
  const bool alone = low.beside || high.beside;
  const double turn = mine.turn_to(other, e), share = alone ? 1 : 0.5 + 0.5 * std::clamp(2 * turn, 0.0, 1.0);
  return share * length * (0.5 * (low.distance + high.distance) + lambda * (1 + turn));
}

/// One surface has one label: exactly one of the two is kept.
void LabelGraph::unite_twins() {
  const WorkMesh &a = p_.side[0], &b = p_.side[1];
  for (int f = 0; f < faces_a_; ++f)
    if (const int g = a.twin[f]; g >= 0 && a.forced[f] * b.forced[g] >= 0) sets_.unite(node(0, f), node(1, g));
}

void LabelGraph::add_edges(int x) {
  const WorkMesh &mine = p_.side[x], &other = p_.side[1 - x];
  for (const WorkMesh::Edge& e : mine.edges) {
    if (e.end_face - e.first_face < 2) continue;
    const double price = cost(mine, other, e);
    for (int k = e.first_face + 1; k < e.end_face; ++k) {
      const int f = mine.edge_faces[k - 1], g = mine.edge_faces[k];
      const bool same = mine.forced[f] && mine.forced[f] == mine.forced[g];
      if (price < 0 || same || (mine.whole[f] && mine.whole[g]))
        sets_.unite(node(x, f), node(x, g));
      else
        arcs_.push_back({node(x, f), node(x, g), capacity(price)});
    }
  }
}

void LabelGraph::add_couplings(int x) {
  const WorkMesh &mine = p_.side[x], &other = p_.side[1 - x];
  for (int f = 0; f < mine.mesh.face_count(); ++f) {
    const WorkMesh::Near& near = mine.face_near[f];
    const double agree = near.distance < reach_ ? agreement(mine, other, f) : 0;
    if (agree > 0) arcs_.push_back({node(x, f), node(1 - x, near.face), capacity(kCoupling * mine.area[f] * agree)});
  }
}

void LabelGraph::add_ties() {
  for (const Tie& t : p_.ties) {
    const std::int64_t price = capacity(t.length * (t.hidden ? kHiddenTie : kTie) * p_.scale);
    arcs_.push_back({node(0, t.a_outside), node(1, t.b_inside), price});
    arcs_.push_back({node(0, t.a_inside), node(1, t.b_outside), price});
  }
}

bool LabelGraph::solve(MeshLabels& labels) {
  constexpr std::int64_t kForced = std::int64_t(1) << 52;
  const int faces = faces_a_ + p_.side[1].mesh.face_count();
  std::vector<int> number(faces, -1);  // of a node, per set
  int nodes = 0;
  for (int i = 0; i < faces; ++i)
    if (int& n = number[sets_.find(i)]; n < 0) n = nodes++;
  const auto of = [&](int x, int f) { return number[sets_.find(node(x, f))]; };
  std::vector<std::int64_t> to_a(nodes, 0), to_b(nodes, 0);
  for (int x : {0, 1})
    for (int f = 0; f < p_.side[x].mesh.face_count(); ++f) {
      const Territory forced = p_.side[x].forced[f], own = x ? kOfB : kOfA, to = forced ? forced : own;
      std::int64_t& sum = (to == kOfA ? to_a : to_b)[of(x, f)];
      sum = std::min(kForced, sum + (forced ? kForced : capacity(kKeepShare * p_.side[x].area[f])));
    }
  WideFlowGraph graph(nodes, int(arcs_.size()));
  graph.add_node(nodes);
  for (int n = 0; n < nodes; ++n)
    if (to_a[n] || to_b[n]) graph.add_tweights(n, to_a[n], to_b[n]);
  for (const Arc& a : arcs_)
    if (const int p = number[sets_.find(a.from)], q = number[sets_.find(a.to)]; p != q)
      graph.add_edge(p, q, a.capacity, a.capacity);
  if (graph.maxflow() >= kForced) return false;
  for (int x : {0, 1}) {
    labels.label[x].resize(p_.side[x].mesh.faces.size());
    for (int f = 0; f < p_.side[x].mesh.face_count(); ++f)
      labels.label[x][f] = graph.what_segment(of(x, f), WideFlowGraph::SINK) == WideFlowGraph::SOURCE ? kOfA : kOfB;
  }
  return true;
}

bool any_seam(const MeshProblem& p, const MeshLabels& labels) {
  for (int x : {0, 1})
    for (const WorkMesh::Edge& e : p.side[x].edges)
      if (p.side[x].cut(e, labels.label[x])) return true;
  return false;
}

/// Counts what a model's own border pays for as a part of the seam, where the other is cut along it.
void take_own_parts(Borders& mine, const Borders& other, double reach) {
  Mesh seam;  // as faces without area
  for (const BorderEdge& e : other.cut) {
    const int v = seam.vertex_count();
    seam.vertices.push_back(e.from), seam.vertices.push_back(e.to);
    seam.faces.push_back({v, v + 1, v + 1});
  }
  const spatial::FaceTree tree(seam);
  for (const BorderEdge& e : std::exchange(mine.own, {}))
    (tree.nearest(0.5 * (e.from + e.to), reach).face >= 0 ? mine.cut : mine.own).push_back(e);
}

/// The borders that labels give a model: those of the faces that it keeps.
Borders label_borders(const WorkMesh& w, const std::vector<Territory>& label, Territory own) {
  Borders borders;
  for (const WorkMesh::Edge& e : w.edges) {
    int kept = 0, face = -1;
    for (int k = e.first_face; k < e.end_face; ++k)
      if (label[w.edge_faces[k]] == own) ++kept, face = w.edge_faces[k];
    if (kept == 0) continue;
    const BorderEdge edge{w.mesh.vertices[e.low], w.mesh.vertices[e.high], w.normal[face]};
    if (e.end_face - e.first_face == 1)
      borders.own.push_back(edge);
    else if (kept < e.end_face - e.first_face)
      borders.cut.push_back(edge);
  }
  return borders;
}

/// The area of faces that lie over each other and are both kept, or both
/// dropped, less the farther apart: of a result in two layers, or with a hole.
double doubled_area(const MeshProblem& p, const MeshLabels& labels) {
  double sum = 0;
  for (int x : {0, 1}) {
    const WorkMesh &mine = p.side[x], &other = p.side[1 - x];
    for (int f = 0; f < mine.mesh.face_count(); ++f) {
      const WorkMesh::Near& near = mine.face_near[f];
      if (near.face < 0 || labels.label[x][f] == labels.label[1 - x][near.face]) continue;
      sum += mine.area[f] * agreement(mine, other, f) * std::max(0.0, 1 - near.distance / (kLayers * p.scale));
    }
  }
  return sum;
}

/// Fills objective, doubled and broken. Not the flow decides, as that pays for one-sided
/// seams by halves, but the seam that the labels make.
void judge(const MeshProblem& p, MeshLabels& labels) {
  Borders a = label_borders(p.side[0], labels.label[0], kOfA), b = label_borders(p.side[1], labels.label[1], kOfB);
  const Borders cut_of_a{a.cut, {}};
  take_own_parts(a, b, SeamScore::kReach * p.scale), take_own_parts(b, cut_of_a, SeamScore::kReach * p.scale);
  labels.objective = score_seam(a, b, p.scale).total();
  labels.doubled = kCoupling * doubled_area(p, labels) / (SeamScore::kLambda * p.scale * p.scale);
  labels.objective += labels.doubled;
  labels.broken = 0;
  for (const Tie& t : p.ties) {
    if (labels.label[0][t.a_outside] == labels.label[1][t.b_inside] &&
        labels.label[0][t.a_inside] == labels.label[1][t.b_outside])
      continue;
    labels.broken += !t.hidden;
    labels.objective += t.length * (t.hidden ? kHiddenTie : kTie) / (SeamScore::kLambda * p.scale);
  }
}

}  // namespace

MeshLabels choose_labels(MeshProblem& problem, double reach, int more, int threads) {
  MeshLabels best;
  const auto attempt = [&](double at, bool curve_only) {
    MeshLabels labels;
    labels.reach = at;
    if (!LabelGraph(problem, at, curve_only).solve(labels)) return false;
    best.possible = labels.possible = true;
    if (!any_seam(problem, labels)) return false;
    judge(problem, labels);
    const bool holds = labels.broken == 0 && labels.doubled <= 0.5 * labels.objective;
    labels.found = true;
    if (!best.found || labels.objective < best.objective) best = std::move(labels);
    return holds || at >= 8 * best.reach;
  };
  for (int x : {0, 1})
    look_nearby(problem.side[x], problem.side[1 - x], std::max(reach, kLayers * problem.scale), threads);
  if (!problem.ties.empty()) attempt(reach, true);
  for (int enough = 0; reach <= kFarthest * problem.scale && enough <= more; reach *= 2) {
    for (int x : {0, 1}) look_nearby(problem.side[x], problem.side[1 - x], reach, threads);
    enough += attempt(reach, false);
  }
  return best;
}

}  // namespace parts::cut
