// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/seam_values.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <queue>
#include <utility>

namespace parts::cut {
namespace {

constexpr double kBand = 3;     // edges from the seam within which values are smoothed
constexpr double kPull = 0.7;   // edges: the radius of the pull to the labels
constexpr double kSpring = 60;  // of springs, against the pull over the band
constexpr double kAgree = 0.2;  // the least cosine of points that a spring joins

class Smoother {
 public:
  Smoother(const Model& a, const Model& b, const MeshProblem& p, const MeshLabels& l, SeamValues& out)
      : a_(a), b_(b), p_(p), l_(l), out_(out) {}

  void measure(double longest);
  void pin(const CrossingCurve& curve);
  void find_partners(const CrossingCurve& curve);
  void solve();

 private:
  const WorkMesh& work(int x) const { return p_.side[x]; }
  void fix_values(int x);
  void share_values();
  void choose_unknowns(int x);
  void share_unknowns();
  void snap();
  void add(int x, int v, int y, int u, double weight);
  void add_mesh(int x);
  void add_springs(int x);

  const Model &a_, &b_;
  const MeshProblem& p_;
  const MeshLabels& l_;
  SeamValues& out_;
  double band_ = 0;
  std::vector<char> at_seam_[2], fixed_[2], zero_[2];  // per vertex
  std::vector<int> number_[2];                         // per vertex: of its unknown, -1 if it is known
  int unknowns_ = 0;
  std::vector<int> partner_;  // per vertex of B: A's at its place, or -1
  std::vector<double> vertex_area_[2];
  std::vector<Eigen::Triplet<double>> matrix_;
  Eigen::VectorXd right_;
};

/// The seam's vertices, its edges' length and how far the borders are apart.
void Smoother::measure(double longest) {
  double gaps = 0, length = 0, edges = 0;
  long count = 0;
  for (int x : {0, 1}) {
    const WorkMesh& w = work(x);
    at_seam_[x].assign(w.mesh.vertices.size(), 0);
    for (const WorkMesh::Edge& e : w.edges) {
      if (!w.cut(e, l_.label[x])) continue;
      at_seam_[x][e.low] = at_seam_[x][e.high] = 1;
      const double l = w.length(e);
      length += l;
      if (e.crossing()) continue;
      const double d = std::min(std::max(w.vertex_near[e.low].distance, w.vertex_near[e.high].distance), l_.reach);
      gaps += l * d, out_.gap = std::max(out_.gap, d);
    }
    const Mesh& m = (x ? b_ : a_).prepared.mesh;
    std::vector<char> counted(m.faces.size(), 0);
    for (int f = 0; f < w.mesh.face_count(); ++f) {
      const Triangle& t = w.mesh.faces[f];
      if (!at_seam_[x][t[0]] && !at_seam_[x][t[1]] && !at_seam_[x][t[2]]) continue;
      if (std::exchange(counted[w.source[f]], 1)) continue;
      for (int k = 0; k < 3; ++k, ++count)
        edges += std::min(longest, (m.corner(w.source[f], k) - m.corner(w.source[f], (k + 1) % 3)).norm());
    }
  }
  out_.edge = count ? edges / double(count) : longest;
  band_ = std::max(kBand * out_.edge, length > 0 ? 1.5 * gaps / length : 0.0);
}

/// Pins the seam to the curve where the models cross at a clear angle.
void Smoother::pin(const CrossingCurve& curve) {
  out_.pinned.assign(curve.segments.size(), 0);
  std::vector<char> still[2];  // vertices of faces that stay whole
  for (int x : {0, 1}) {
    const Model& model = x ? b_ : a_;
    still[x].assign(model.prepared.mesh.vertices.size(), 0);
    for (int f = 0; f < work(x).mesh.face_count(); ++f)
      if (const int s = work(x).source[f]; model.keep[s] || work(x).whole[f])
        for (int v : model.prepared.mesh.faces[s]) still[x][v] = 1;
    zero_[x].assign(work(x).mesh.vertices.size(), 0);
  }
  for (const Tie& t : p_.ties) {
    if (l_.label[0][t.a_outside] == l_.label[0][t.a_inside] || l_.label[1][t.b_outside] == l_.label[1][t.b_inside])
      continue;
    bool free = t.clear;
    for (int end : curve.segments[t.segment].ends)
      for (int x : {0, 1}) {
        const std::array<int, 2>& edge = curve.points[end].on[x].edge;
        free = free && !(edge[0] >= 0 && still[x][edge[0]] && still[x][edge[1]]);
      }
    if (!free) continue;
    out_.pinned[t.segment] = 1;
    for (int end : curve.segments[t.segment].ends)
      for (int x : {0, 1}) zero_[x][work(x).vertex_of[end]] = 1;
  }
}

/// Starts with the labels' area mean, and the label itself where it is forced.
void Smoother::fix_values(int x) {
  const WorkMesh& w = work(x);
  const std::vector<Territory>& label = l_.label[x];
  std::vector<double>& value = out_.value[x];
  std::vector<double> weight(w.mesh.vertices.size(), 0);
  value.assign(w.mesh.vertices.size(), 0), fixed_[x].assign(w.mesh.vertices.size(), 0);
  const double hair = 1e-12 * p_.scale * p_.scale;  // faces without area have a say where there are no others
  for (int f = 0; f < w.mesh.face_count(); ++f)
    for (int v : w.mesh.faces[f]) value[v] += label[f] * (w.area[f] + hair), weight[v] += w.area[f] + hair;
  for (std::size_t v = 0; v < value.size(); ++v) value[v] = weight[v] > 0 ? value[v] / weight[v] : x ? 1 : -1;
  // What is kept has the last word.
  const Territory own = x ? kOfB : kOfA;
  for (const bool kept : {false, true})
    for (int f = 0; f < w.mesh.face_count(); ++f)
      if ((w.forced[f] || w.whole[f]) && (label[f] == own) == kept)
        for (int v : w.mesh.faces[f]) value[v] = label[f], fixed_[x][v] = 1;
  // But where the border is pinned it may end along what is kept.
  for (std::size_t v = 0; v < value.size(); ++v)
    if (zero_[x][v]) value[v] = 0, fixed_[x][v] = 1;
}

/// Vertices of B that lie where one of A does, and where the two are one surface, have its value.
void Smoother::find_partners(const CrossingCurve& curve) {
  partner_.assign(work(1).mesh.vertices.size(), -1);
  std::vector<char> of_twin[2];
  for (int x : {0, 1}) {
    of_twin[x].assign(work(x).mesh.vertices.size(), 0);
    for (int f = 0; f < work(x).mesh.face_count(); ++f)
      if (work(x).twin[f] >= 0)
        for (int v : work(x).mesh.faces[f]) of_twin[x][v] = 1;
  }
  for (std::size_t p = 0; p < curve.points.size(); ++p) {
    const int v = work(0).vertex_of[p], u = work(1).vertex_of[p];
    if (v >= 0 && u >= 0 && of_twin[0][v] && of_twin[1][u]) partner_[u] = v;
  }
}

/// What is known of one of two partners holds for both.
void Smoother::share_values() {
  for (int u = 0; u < int(partner_.size()); ++u) {
    const int v = partner_[u];
    if (v < 0) continue;
    double &of_a = out_.value[0][v], &of_b = out_.value[1][u];
    if (fixed_[0][v] && !fixed_[1][u])
      of_b = of_a, fixed_[1][u] = 1;
    else if (fixed_[1][u] && !fixed_[0][v])
      of_a = of_b, fixed_[0][v] = 1;
  }
}

/// Vertices within the band along edges of the seam.
void Smoother::choose_unknowns(int x) {
  const WorkMesh& w = work(x);
  const Mesh& m = w.mesh;
  std::vector<int> start(m.vertices.size() + 2, 0);
  for (const WorkMesh::Edge& e : w.edges) ++start[e.low + 2], ++start[e.high + 2];
  for (std::size_t v = 2; v < start.size(); ++v) start[v] += start[v - 1];
  std::vector<int> next(w.edges.size() * 2);
  for (const WorkMesh::Edge& e : w.edges) next[start[e.low + 1]++] = e.high, next[start[e.high + 1]++] = e.low;
  std::vector<double> away(m.vertices.size(), 1e300);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (int v = 0; v < m.vertex_count(); ++v)
    if (at_seam_[x][v]) queue.push({away[v] = 0, v});
  number_[x].assign(m.vertices.size(), -1);
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > away[v]) continue;
    if (!fixed_[x][v]) number_[x][v] = unknowns_++;
    for (int k = start[v]; k < start[v + 1]; ++k)
      if (const double e = d + (m.vertices[next[k]] - m.vertices[v]).norm(); e < away[next[k]] && e < band_)
        queue.push({away[next[k]] = e, next[k]});
  }
}

/// Partners are one unknown. (The other's number is left over.)
void Smoother::share_unknowns() {
  for (int u = 0; u < int(partner_.size()); ++u) {
    const int v = partner_[u];
    if (v < 0 || fixed_[0][v] || fixed_[1][u]) continue;
    int &of_a = number_[0][v], &of_b = number_[1][u];
    (of_a >= 0 ? of_b : of_a) = of_a >= 0 ? of_a : of_b;
  }
  int next = 0;
  std::vector<int> renumbered(unknowns_, -1);
  for (int x : {0, 1})
    for (int& n : number_[x])
      if (n >= 0) {
        if (renumbered[n] < 0) renumbered[n] = next++;
        n = renumbered[n];
      }
  unknowns_ = next;
}

/// Adds weight * (value of x's v - value of y's u)².
void Smoother::add(int x, int v, int y, int u, double weight) {
  const int i = number_[x][v], j = number_[y][u];
  if (i >= 0) matrix_.emplace_back(i, i, weight);
  if (j >= 0) matrix_.emplace_back(j, j, weight);
  if (i >= 0 && j >= 0) matrix_.emplace_back(i, j, -weight), matrix_.emplace_back(j, i, -weight);
  if (i >= 0 && j < 0) right_[i] += weight * out_.value[y][u];
  if (j >= 0 && i < 0) right_[j] += weight * out_.value[x][v];
}

void Smoother::add_mesh(int x) {
  const WorkMesh& w = work(x);
  const Mesh& m = w.mesh;
  vertex_area_[x].assign(m.vertices.size(), 0);
  const double pull = 2.0 / 3 / (kPull * kPull * out_.edge * out_.edge);
  for (int f = 0; f < m.face_count(); ++f) {
    const Triangle& t = m.faces[f];
    if (number_[x][t[0]] < 0 && number_[x][t[1]] < 0 && number_[x][t[2]] < 0) continue;
    for (int k = 0; k < 3; ++k) {
      const int i = t[k], j = t[(k + 1) % 3], o = t[(k + 2) % 3];
      vertex_area_[x][i] += w.area[f] / 3;
      const Vec3 p = m.vertices[i] - m.vertices[o], q = m.vertices[j] - m.vertices[o];
      const double cross = p.cross(q).norm();
      add(x, i, x, j, std::clamp(cross > 0 ? p.dot(q) / cross : 0.0, 0.05, 5.0));
      if (const int n = number_[x][i]; n >= 0) {
        matrix_.emplace_back(n, n, pull * w.area[f]);
        right_[n] += pull * w.area[f] * l_.label[x][f];
      }
    }
  }
}

void Smoother::add_springs(int x) {
  const WorkMesh &w = work(x), &other = work(1 - x);
  for (int v = 0; v < w.mesh.vertex_count(); ++v) {
    const WorkMesh::Near& near = w.vertex_near[v];
    if (near.face < 0 || near.beside) continue;
    const double agree = w.vertex_normal[v].dot(other.normal[near.face]);
    const Triangle& t = other.mesh.faces[near.face];
    bool any = number_[x][v] >= 0;
    for (int u : t) any |= number_[1 - x][u] >= 0;
    if (agree < kAgree || !any) continue;
    const double area = vertex_area_[x][v] > 0 ? vertex_area_[x][v] : out_.edge * out_.edge;
    const double strength = kSpring * area / (band_ * band_) * agree;
    const Vec3 n = other.mesh.area_vector(near.face), &a = other.mesh.vertices[t[0]], &b = other.mesh.vertices[t[1]],
               &c = other.mesh.vertices[t[2]];
    const double whole = n.squaredNorm();
    if (!(whole > 0)) continue;
    const double l1 = (near.point - a).cross(c - a).dot(n) / whole, l2 = (b - a).cross(near.point - a).dot(n) / whole;
    const double share[3] = {1 - l1 - l2, l1, l2};
    for (int k = 0; k < 3; ++k)
      if (share[k] > 1e-3) add(x, v, 1 - x, t[k], strength * std::min(share[k], 1.0));
  }
}

void Smoother::solve() {
  for (int x : {0, 1}) fix_values(x);
  share_values();
  for (int x : {0, 1}) choose_unknowns(x);
  share_unknowns();
  if (unknowns_ == 0) return snap();
  const int n = unknowns_;
  right_.setZero(n);
  for (int x : {0, 1}) add_mesh(x);
  for (int x : {0, 1}) add_springs(x);
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(matrix_.begin(), matrix_.end());
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) return snap();  // the labels' mean stays
  const Eigen::VectorXd solved = solver.solve(right_);
  for (int x : {0, 1})
    for (std::size_t v = 0; v < number_[x].size(); ++v)
      if (number_[x][v] >= 0) out_.value[x][v] = std::clamp(solved[number_[x][v]], -1.0, 1.0);
  snap();
}

/// A border that passes close by a vertex goes through it: no slivers come about. Only these and pinned
/// vertices lie on the border itself.
void Smoother::snap() {
  constexpr double kClose = 0.05;  // of an edge
  std::vector<char> close(unknowns_, 0);
  for (int x : {0, 1})
    for (const WorkMesh::Edge& e : work(x).edges) {
      const double low = out_.value[x][e.low], high = out_.value[x][e.high];
      if (!(low * high < 0)) continue;
      const double share = low / (low - high);
      if (const int n = number_[x][e.low]; n >= 0 && share < kClose) close[n] = 1;
      if (const int n = number_[x][e.high]; n >= 0 && share > 1 - kClose) close[n] = 1;
    }
  for (int x : {0, 1})
    for (std::size_t v = 0; v < number_[x].size(); ++v) {
      double& value = out_.value[x][v];
      if (number_[x][v] >= 0 && close[number_[x][v]])
        value = 0;
      else if (value == 0 && !zero_[x][v])
        value = 1e-6;
    }
}

}  // namespace

SeamValues smooth_values(const Model& a, const Model& b, const MeshProblem& problem, const MeshLabels& labels,
                         const CrossingCurve& curve, double longest) {
  SeamValues values;
  Smoother smoother(a, b, problem, labels, values);
  smoother.measure(longest);
  smoother.pin(curve);
  smoother.find_partners(curve);
  smoother.solve();
  return values;
}

}  // namespace parts::cut
