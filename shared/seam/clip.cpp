// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/clip.h"

#include <algorithm>
#include <unordered_map>

#include "parts/base/disjoint_sets.h"
#include "parts/base/parallel.h"
#include "parts/mesh/attributes.h"

namespace parts::seam {
namespace {

constexpr double kPinned = 0.05;  // the least value at a vertex of a pinned face

/// The mesh while faces are replaced by parts of themselves.
struct Work {
  Mesh mesh;
  std::vector<int> source;
  std::vector<signed char> pinned;
  std::vector<char> dead;
  std::vector<double> value;  ///< per vertex

  int add(int parent, const Triangle& v, const std::array<Vec3, 3>& at) {
    mesh::add_face_within(mesh, parent, v, at);
    source.push_back(source[parent]);
    pinned.push_back(pinned[parent]);
    dead.push_back(0);
    return mesh.face_count() - 1;
  }
};

std::uint64_t edge_key(int a, int b) {
  return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

using EdgePoints = std::unordered_map<std::uint64_t, int>;

/// Replaces a face by two, three or four at its edges' marked midpoints
/// (mid[k] on edge k, -1 if unmarked). @return the first new face
int split_face(Work& w, int f, std::array<int, 3> mid) {
  const int first = w.mesh.face_count();
  const Triangle t = w.mesh.faces[f];
  const int marked = (mid[0] >= 0) + (mid[1] >= 0) + (mid[2] >= 0);
  int r = 0;  // rotation that brings the pattern into its standard place
  while (marked == 1 ? mid[r] < 0 : marked == 2 && mid[(r + 2) % 3] >= 0) ++r;
  std::array<int, 3> v, m;
  std::array<Vec3, 3> at_v, at_m;
  for (int k = 0; k < 3; ++k) {
    const int c = (k + r) % 3;
    v[k] = t[c], m[k] = mid[c];
    at_v[k] = Vec3::Unit(c), at_m[k] = 0.5 * (Vec3::Unit(c) + Vec3::Unit((c + 1) % 3));
  }
  w.dead[f] = 1;
  if (marked == 1) {
    w.add(f, {v[0], m[0], v[2]}, {at_v[0], at_m[0], at_v[2]});
    w.add(f, {m[0], v[1], v[2]}, {at_m[0], at_v[1], at_v[2]});
  } else if (marked == 2) {
    w.add(f, {m[0], v[1], m[1]}, {at_m[0], at_v[1], at_m[1]});
    const auto& p = w.mesh.vertices;
    if ((p[v[0]] - p[m[1]]).squaredNorm() < (p[m[0]] - p[v[2]]).squaredNorm()) {
      w.add(f, {v[0], m[0], m[1]}, {at_v[0], at_m[0], at_m[1]});
      w.add(f, {v[0], m[1], v[2]}, {at_v[0], at_m[1], at_v[2]});
    } else {
      w.add(f, {v[0], m[0], v[2]}, {at_v[0], at_m[0], at_v[2]});
      w.add(f, {m[0], m[1], v[2]}, {at_m[0], at_m[1], at_v[2]});
    }
  } else {
    w.add(f, {v[0], m[0], m[2]}, {at_v[0], at_m[0], at_m[2]});
    w.add(f, {m[0], v[1], m[1]}, {at_m[0], at_v[1], at_m[1]});
    w.add(f, {m[2], m[1], v[2]}, {at_m[2], at_m[1], at_v[2]});
    w.add(f, {m[0], m[1], m[2]}, {at_m[0], at_m[1], at_m[2]});
  }
  return first;
}

/// Splits the edges of crossed faces down to max_edge, so that the field's sign
/// at the vertices tells where it passes. Pinned faces are left as they are.
class Refinement {
 public:
  Refinement(Work& w, const ClipField& field, int threads) : w_(w), field_(field), crossed_(w.mesh.faces.size(), 0) {
    parallel_for(w.mesh.face_count(), threads, [&](long begin, long end) {
      for (int f = int(begin); f < end; ++f) crossed_[f] = !w_.pinned[f] && crosses(f);
    });
    find_zone();
  }

  /// Each round halves what is too long.
  void run() {
    for (int round = rounds(); round > 0; --round)
      if (!halve()) return;
  }

 private:
  double length(int a, int b) const { return (w_.mesh.vertices[a] - w_.mesh.vertices[b]).norm(); }
  double longest(int f) const {
    const Triangle& t = w_.mesh.faces[f];
    return std::max({length(t[0], t[1]), length(t[1], t[2]), length(t[2], t[0])});
  }
  bool crosses(int f) const { return longest(f) > field_.max_edge && field_.crosses(w_.mesh, f); }
  bool stays_whole(int a, int b) const { return whole_.count(edge_key(a, b)) > 0; }

  void find_zone();
  int rounds() const;
  double long_enough(int f) const;
  void mark_midpoints(int f);
  std::array<int, 3> midpoints_of(int f) const;
  bool halve();

  Work& w_;
  const ClipField& field_;
  std::vector<char> crossed_;  ///< per face
  std::vector<int> zone_;      ///< crossed faces and those that share an edge with one
  EdgePoints whole_;           ///< edges of pinned faces near the zone
  EdgePoints mid_;             ///< of this round
};

void Refinement::find_zone() {
  const Mesh& mesh = w_.mesh;
  std::vector<char> touched(mesh.vertices.size(), 0);
  for (int f = 0; f < mesh.face_count(); ++f)
    if (crossed_[f])
      for (int v : mesh.faces[f]) touched[v] = 1;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Triangle& t = mesh.faces[f];
    if (touched[t[0]] + touched[t[1]] + touched[t[2]] < 2) continue;
    if (!w_.pinned[f])
      zone_.push_back(f);
    else
      for (int k = 0; k < 3; ++k) whole_[edge_key(t[k], t[(k + 1) % 3])] = 1;
  }
}

/// Bounded: flat faces beside an edge that must stay whole could go on for ever.
int Refinement::rounds() const {
  double most = 0;
  for (int f : zone_) most = std::max(most, crossed_[f] ? longest(f) : 0);
  return most > field_.max_edge ? 2 + int(std::log2(std::min(most / field_.max_edge, 1e6))) : 0;
}

/// Edges of a face that are no longer than this are left. Beside an edge that
/// must stay whole, splitting the others down to its length would never end.
double Refinement::long_enough(int f) const {
  const Triangle& t = w_.mesh.faces[f];
  double enough = field_.max_edge;
  for (int k = 0; k < 3; ++k)
    if (const int a = t[k], b = t[(k + 1) % 3]; stays_whole(a, b)) enough = std::max(enough, 1.5 * length(a, b));
  return enough;
}

void Refinement::mark_midpoints(int f) {
  const double enough = long_enough(f);
  const Triangle t = w_.mesh.faces[f];
  for (int k = 0; k < 3; ++k) {
    const int a = t[k], b = t[(k + 1) % 3];
    if (length(a, b) <= enough || stays_whole(a, b)) continue;
    const auto [it, fresh] = mid_.try_emplace(edge_key(a, b), -1);
    if (!fresh) continue;
    it->second = mesh::add_vertex_between(w_.mesh, std::min(a, b), std::max(a, b), 0.5);
    w_.value.push_back(field_.value(w_.mesh.vertices.back()));
  }
}

std::array<int, 3> Refinement::midpoints_of(int f) const {
  std::array<int, 3> m;
  for (int k = 0; k < 3; ++k) {
    const auto it = mid_.find(edge_key(w_.mesh.faces[f][k], w_.mesh.faces[f][(k + 1) % 3]));
    m[k] = it == mid_.end() ? -1 : it->second;
  }
  return m;
}

/// @return whether anything was split
bool Refinement::halve() {
  mid_.clear();
  for (int f : zone_)
    if (crossed_[f]) mark_midpoints(f);
  if (mid_.empty()) return false;
  std::vector<int> next;
  for (int f : zone_) {
    const std::array<int, 3> m = midpoints_of(f);
    if (m[0] < 0 && m[1] < 0 && m[2] < 0) {
      next.push_back(f);
      continue;
    }
    const int first = split_face(w_, f, m);
    crossed_.resize(w_.mesh.faces.size(), 0);
    for (int g = first; g < w_.mesh.face_count(); ++g) {
      crossed_[g] = crossed_[f] && crosses(g);
      next.push_back(g);
    }
  }
  zone_.swap(next);
  return true;
}

/// The share of the way from vertex i (kept) to j (not) at which the field
/// vanishes: false position with halving (Illinois).
double root(const Work& w, const ClipField& field, int i, int j) {
  constexpr double kMargin = 0.01;  // no face gets an edge of no length
  double t0 = 0, t1 = 1, f0 = w.value[i], f1 = w.value[j], t = f0 / (f0 - f1);
  int side = 0;
  for (int step = 0; step < 24 && t1 - t0 > 1e-4; ++step) {
    t = f0 == -f1 || step > 10 ? 0.5 * (t0 + t1) : (t0 * f1 - t1 * f0) / (f1 - f0);
    const double f = field.value((1 - t) * w.mesh.vertices[i] + t * w.mesh.vertices[j]);
    if (std::abs(f) < 1e-9) break;
    if (f > 0) {
      t0 = t, f0 = f;
      if (side == 1) f1 /= 2;
      side = 1;
    } else {
      t1 = t, f1 = f;
      if (side == -1) f0 /= 2;
      side = -1;
    }
  }
  return std::clamp(t, kMargin, 1 - kMargin);
}

/// Cuts faces in two where the field changes its sign between their corners.
class Cutter {
 public:
  Cutter(Work& w, const ClipField& field) : w_(w), field_(field) {}

  void cut(int face);
  std::vector<std::array<int, 2>> border;

 private:
  /// The new vertex on an edge.
  int point(int inside, int outside) {
    const auto [it, fresh] = points_.try_emplace(edge_key(inside, outside), -1);
    if (fresh) it->second = mesh::add_vertex_between(w_.mesh, inside, outside, root(w_, field_, inside, outside));
    return it->second;
  }
  /// The barycentric place of point p on the edge that starts at corner k.
  Vec3 share(int f, int k, int p) const {
    const Vec3 &a = w_.mesh.corner(f, k), &b = w_.mesh.corner(f, (k + 1) % 3);
    const double length = (b - a).norm(), t = length > 0 ? (w_.mesh.vertices[p] - a).norm() / length : 0;
    return (1 - t) * Vec3::Unit(k) + t * Vec3::Unit((k + 1) % 3);
  }

  Work& w_;
  const ClipField& field_;
  EdgePoints points_;
};

void Cutter::cut(int f) {
  const Triangle t = w_.mesh.faces[f];
  bool in[3];
  for (int k = 0; k < 3; ++k) in[k] = w_.value[t[k]] > 0;
  const int inside = in[0] + in[1] + in[2];
  if (inside == 3) return;
  w_.dead[f] = 1;
  if (inside == 0) return;
  // Corner a is the one that stands alone; its edges to b and c are cut.
  const int k = inside == 1 ? (in[0] ? 0 : in[1] ? 1 : 2) : (!in[0] ? 0 : !in[1] ? 1 : 2);
  const int kb = (k + 1) % 3, kc = (k + 2) % 3, a = t[k], b = t[kb], c = t[kc];
  const int ab = inside == 1 ? point(a, b) : point(b, a), ac = inside == 1 ? point(a, c) : point(c, a);
  const Vec3 at_ab = share(f, k, ab), at_ac = share(f, kc, ac);
  if (inside == 1) {
    w_.add(f, {a, ab, ac}, {Vec3::Unit(k), at_ab, at_ac});
    border.push_back({ab, ac});
    return;
  }
  const auto& p = w_.mesh.vertices;
  if ((p[ab] - p[c]).squaredNorm() < (p[ac] - p[b]).squaredNorm()) {
    w_.add(f, {ab, b, c}, {at_ab, Vec3::Unit(kb), Vec3::Unit(kc)});
    w_.add(f, {ab, c, ac}, {at_ab, Vec3::Unit(kc), at_ac});
  } else {
    w_.add(f, {ab, b, ac}, {at_ab, Vec3::Unit(kb), at_ac});
    w_.add(f, {b, c, ac}, {Vec3::Unit(kb), Vec3::Unit(kc), at_ac});
  }
  border.push_back({ac, ab});
}

/// Takes out pieces with cut borders that are no larger than a crumb and of
/// which nothing is pinned: the field's noise where it runs along the surface.
void drop_crumbs(const Work& w, double crumb, int whole_vertices, std::vector<char>& keep,
                 std::vector<std::array<int, 2>>& border) {
  DisjointSets pieces(w.mesh.vertex_count());
  for (std::size_t f = 0; f < keep.size(); ++f)
    if (keep[f])
      for (int k : {1, 2}) pieces.unite(w.mesh.faces[f][0], w.mesh.faces[f][k]);
  std::unordered_map<int, Box> boxes;  // of pieces that the cut made
  for (const auto& e : border)
    if (e[0] >= whole_vertices) boxes[pieces.find(e[0])];
  for (std::size_t f = 0; f < keep.size(); ++f) {
    if (!keep[f]) continue;
    const auto piece = boxes.find(pieces.find(w.mesh.faces[f][0]));
    if (piece == boxes.end()) continue;
    if (w.pinned[f] > 0)
      boxes.erase(piece);
    else
      piece->second.extend(w.mesh.face_box(int(f)));
  }
  const auto is_crumb = [&](int vertex) {
    const auto piece = boxes.find(pieces.find(vertex));
    return piece != boxes.end() && piece->second.sizes().maxCoeff() < crumb;
  };
  for (std::size_t f = 0; f < keep.size(); ++f) keep[f] = keep[f] && !is_crumb(w.mesh.faces[f][0]);
  border.erase(std::remove_if(border.begin(), border.end(), [&](const auto& e) { return is_crumb(e[0]); }),
               border.end());
}

/// The field at the vertices; those of pinned faces lie on their side.
Work start(const Mesh& mesh, const std::vector<signed char>& pinned, const ClipField& field, int threads) {
  Work w{mesh, {}, pinned, std::vector<char>(mesh.faces.size(), 0), std::vector<double>(mesh.vertices.size())};
  for (int f = 0; f < mesh.face_count(); ++f) w.source.push_back(f);
  parallel_for(mesh.vertex_count(), threads, [&](long begin, long end) {
    for (long v = begin; v < end; ++v) w.value[v] = field.value(mesh.vertices[v]);
  });
  for (int f = 0; f < mesh.face_count(); ++f)
    if (pinned[f] < 0)
      for (int v : mesh.faces[f]) w.value[v] = std::min(w.value[v], -kPinned);
  for (int f = 0; f < mesh.face_count(); ++f)
    if (pinned[f] > 0)
      for (int v : mesh.faces[f]) w.value[v] = std::max(w.value[v], kPinned);
  return w;
}

Clipped take_kept(const Work& w, const std::vector<char>& keep, const std::vector<std::array<int, 2>>& border,
                  int whole_vertices) {
  Clipped out;
  std::vector<int> old_vertex, old_face, number(w.mesh.vertices.size(), -1);
  out.mesh = mesh::take_faces(w.mesh, keep, &old_vertex, &old_face);
  for (int f : old_face) out.source_face.push_back(w.source[f]);
  for (std::size_t v = 0; v < old_vertex.size(); ++v) {
    number[old_vertex[v]] = int(v);
    out.cut_vertex.push_back(old_vertex[v] >= whole_vertices);
  }
  for (const auto& e : border) out.border.push_back({number[e[0]], number[e[1]]});
  return out;
}

}  // namespace

Clipped clip(const Mesh& mesh, const std::vector<signed char>& pinned, const ClipField& field, int threads) {
  Work w = start(mesh, pinned, field, threads);
  Refinement(w, field, threads).run();
  const int whole_vertices = w.mesh.vertex_count(), whole_faces = w.mesh.face_count();
  Cutter cutter(w, field);
  for (int f = 0; f < whole_faces; ++f)
    if (!w.dead[f]) cutter.cut(f);
  std::vector<char> keep;
  for (char d : w.dead) keep.push_back(!d);
  drop_crumbs(w, field.crumb, whole_vertices, keep, cutter.border);
  return take_kept(w, keep, cutter.border, whole_vertices);
}

}  // namespace parts::seam
