// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>
#include <set>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/attributes.h"
#include "parts/seam/cap.h"
#include "parts/seam/contours.h"
#include "parts/seam/joined.h"
#include "parts/seam/pieces.h"
#include "parts/seam/stitch.h"

namespace parts::seam {
namespace {

/// The stitching of two clipped models, step by step.
class Stitching {
 public:
  Stitching(Joined& j, double max_gap, SeamReport& report) : j_(j), max_gap_(max_gap), report_(report) {
    part(j.loops_a, rings_a_, rest_a_), part(j.loops_b, rings_b_, rest_b_);
  }

  double run() {
    auto pairs = mesh::match_loops(j_.mesh, rings_a_, rings_b_, max_gap_, report_.seam_gap);
    j_.gap = report_.seam_gap;
    agree_on_orientation(pairs);
    for (const auto& [i, k] : pairs) join(rings_a_[i], rings_b_[k]);
    keep_unpaired(pairs);
    join_pieces();
    join_own_borders();
    find_flaps();
    const double unmatched = close_or_leave();
    remove_flaps();
    return unmatched;
  }

 private:
  Contour contour(const mesh::Loop& loop) const {
    Contour c{loop, {}};
    for (int i = 0; i < loop.size(); ++i)
      c.own.push_back(contains(j_.own, {loop.vertices[i], loop.vertices[(i + 1) % loop.size()]}));
    return c;
  }
  std::vector<Contour> contours(const std::vector<mesh::Loop>& rings, const std::vector<mesh::Loop>& rest) const {
    std::vector<Contour> c;
    for (const mesh::Loop& l : rings) c.push_back(contour(l));
    for (const mesh::Loop& l : rest) c.push_back(contour(l));
    return c;
  }
  bool any_own(const mesh::Loop& loop) const {
    bool any = false;
    for_each_half_edge(loop, [&](const auto& e) { any |= contains(j_.own, e); });
    return any;
  }
  /// The cut made it, and no strip's end did.
  bool made_by_cut(const std::array<int, 2>& e) const {
    return !contains(j_.own, e) && (j_.seam[e[0]] & j_.seam[e[1]]) != 0;
  }
  double length(const std::array<int, 2>& e) const { return (j_.mesh.vertices[e[0]] - j_.mesh.vertices[e[1]]).norm(); }

  void part(const std::vector<mesh::Loop>& loops, std::vector<mesh::Loop>& rings, std::vector<mesh::Loop>& rest) const {
    for (const mesh::Loop& l : loops) (any_own(l) ? rest : rings).push_back(l);
  }
  void agree_on_orientation(HalfEdges& pairs);
  double facing_agreement(double& length) const;
  void turn_b();
  void join(const mesh::Loop& a, const mesh::Loop& b);
  void keep_unpaired(const HalfEdges& pairs);
  void join_pieces();
  void join_own_borders();
  void find_flaps();
  double close_or_leave();
  void remove_flaps();

  Joined& j_;
  const double max_gap_;
  SeamReport& report_;
  std::vector<mesh::Loop> rings_a_, rings_b_;  ///< contours that the cut made all around
  std::vector<mesh::Loop> rest_a_, rest_b_;    ///< those that run on along an input's border
  std::vector<mesh::Loop> left_;               ///< what is still open
  std::vector<char> flap_;                     ///< per face: goes
};

/// How far the parts of mixed contours run the same way as what of B is nearest
/// to them, times their length.
double Stitching::facing_agreement(double& length) const {
  constexpr int kReach = 3;  // vertices to both sides that give a direction
  const auto cut_places = [&](const std::vector<mesh::Loop>& loops) {
    std::vector<std::pair<Vec3, Vec3>> places;  // where, and which way
    for (const mesh::Loop& l : loops)
      for (int i = 0; i < l.size(); ++i) {
        const int n = l.size(), v = l.vertices[i], next = l.vertices[(i + 1) % n];
        if ((!l.closed && i + 1 == n) || contains(j_.own, {v, next})) continue;
        const auto at = [&](int k) { return l.closed ? (k % n + n) % n : std::clamp(k, 0, n - 1); };
        places.emplace_back(
            j_.mesh.vertices[v],
            (j_.mesh.vertices[l.vertices[at(i + kReach)]] - j_.mesh.vertices[l.vertices[at(i - kReach)]]).normalized());
      }
    return places;
  };
  std::vector<mesh::Loop> all_b = rest_b_;
  all_b.insert(all_b.end(), rings_b_.begin(), rings_b_.end());
  const auto of_b = cut_places(all_b);
  double balance = 0;
  for (const auto& [at, way] : cut_places(rest_a_)) {
    double least = max_gap_ * max_gap_;
    const std::pair<Vec3, Vec3>* nearest = nullptr;
    for (const auto& b : of_b)
      if (const double d = (b.first - at).squaredNorm(); d < least) least = d, nearest = &b;
    if (nearest) balance += way.dot(nearest->second), ++length;
  }
  return balance;
}

/// Turns B's part over if the seam says clearly that it faces the other way.
void Stitching::agree_on_orientation(HalfEdges& pairs) {
  const auto agreement = [&](const auto& p) { return direction_agreement(j_.mesh, rings_a_[p[0]], rings_b_[p[1]]); };
  if (j_.may_turn_b) {
    double balance = 0, length = 0;
    for (const auto& p : pairs) {
      const double l = mesh::loop_length(j_.mesh, rings_a_[p[0]]);
      balance += l * agreement(p), length += l;
    }
    if (pairs.empty()) balance = facing_agreement(length);
    if (balance > 0.5 * length) turn_b();
  }
  // What still runs the wrong way would make a twisted strip.
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), [&](const auto& p) { return agreement(p) > 0; }), pairs.end());
}

void Stitching::turn_b() {
  report_.reversed_b = true;
  std::vector<char> of_b(j_.mesh.vertices.size(), 0);
  for (int f = 0; f < j_.mesh.face_count(); ++f)
    if (j_.tag[f] == 1) {
      for (int v : j_.mesh.faces[f]) of_b[v] = 1;
      std::swap(j_.mesh.faces[f][1], j_.mesh.faces[f][2]);
      if (!j_.mesh.wedges.empty()) std::swap(j_.mesh.wedges[f].uv[1], j_.mesh.wedges[f].uv[2]);
    }
  for (std::size_t v = 0; v < j_.mesh.vertex_normal.size(); ++v)
    if (of_b[v]) j_.mesh.vertex_normal[v] = -j_.mesh.vertex_normal[v];
  for (std::vector<mesh::Loop>* loops : {&j_.loops_b, &j_.own_b, &rings_b_, &rest_b_})
    for (mesh::Loop& l : *loops) std::reverse(l.vertices.begin(), l.vertices.end());
  for (auto& e : j_.own)
    if (of_b[e[0]]) std::swap(e[0], e[1]);
  std::sort(j_.own.begin(), j_.own.end());
}

void Stitching::join(const mesh::Loop& a, const mesh::Loop& b) {
  ++report_.loops_joined;
  report_.seam_length += mesh::loop_length(j_.mesh, a);
  zipper(j_.mesh, a, b, j_.like);
}

void Stitching::keep_unpaired(const HalfEdges& pairs) {
  std::vector<char> joined_a(rings_a_.size(), 0), joined_b(rings_b_.size(), 0);
  for (const auto& [i, k] : pairs) joined_a[i] = joined_b[k] = 1;
  const auto keep = [](std::vector<mesh::Loop>& loops, const std::vector<char>& joined) {
    std::vector<mesh::Loop> unpaired;
    for (std::size_t i = 0; i < loops.size(); ++i)
      if (!joined[i]) unpaired.push_back(std::move(loops[i]));
    loops.swap(unpaired);
  };
  keep(rings_a_, joined_a), keep(rings_b_, joined_b);
}

/// What does not pair off is zippered by pieces.
void Stitching::join_pieces() {
  ZipperedPieces pieces =
      zipper_pieces(j_.mesh, contours(rings_a_, rest_a_), contours(rings_b_, rest_b_), max_gap_, j_.like);
  report_.pieces_joined += pieces.strips, report_.seam_length += pieces.length;
  left_ = std::move(pieces.open);
}

/// What the cut left of one model and faces a border that the other had: a scan
/// laid on a surface that was cut all around it.
void Stitching::join_own_borders() {
  for (const char side : {kBorderA, kBorderB}) {
    const std::vector<mesh::Loop>& own = side == kBorderA ? j_.own_b : j_.own_a;
    std::vector<mesh::Loop> lonely, others;
    for (mesh::Loop& l : left_) {
      const bool of_side = std::all_of(l.vertices.begin(), l.vertices.end(), [&](int v) { return j_.seam[v] == side; });
      (of_side && !any_own(l) ? lonely : others).push_back(std::move(l));
    }
    left_.swap(others);
    if (!lonely.empty() && !own.empty()) {
      ZipperedPieces pieces = zipper_pieces(j_.mesh, contours(lonely, {}), contours(own, {}), max_gap_, j_.like);
      report_.pieces_joined += pieces.strips, report_.seam_length += pieces.length;
      lonely = std::move(pieces.open);
    }
    for (mesh::Loop& l : lonely) {
      bool made = false;  // an own border that nothing was joined to is none of ours
      for_each_half_edge(l, [&](const auto& e) { made |= !contains(j_.own, e); });
      if (made) left_.push_back(std::move(l));
    }
  }
}

/// Marks what the cut severed from its model and nothing was joined to: no
/// larger than the gap that is bridged, or open and a small part of its model;
/// and nothing of it kept.
void Stitching::find_flaps() {
  constexpr double kSmall = 0.05;  // of its model's area
  if (left_.empty()) return;
  j_.tag.resize(j_.mesh.faces.size(), 2);
  DisjointSets pieces(j_.mesh.vertex_count());
  for (const Triangle& f : j_.mesh.faces)
    for (int k : {1, 2}) pieces.unite(f[0], f[k]);
  struct Piece {
    bool stays = false, open = false;
    double area = 0;
    Box box;
  };
  std::map<int, Piece> severed;
  for (const mesh::Loop& l : left_) severed[pieces.find(l.vertices[0])].open |= !l.closed || any_own(l);
  double whole[2] = {0, 0};
  const auto piece_of = [&](int f) { return severed.find(pieces.find(j_.mesh.faces[f][0])); };
  for (int f = 0; f < j_.mesh.face_count(); ++f) {
    const double area = j_.mesh.area(f);
    if (j_.tag[f] < 2) whole[int(j_.tag[f])] += area;
    const auto p = piece_of(f);
    if (p == severed.end()) continue;
    p->second.stays |= j_.tag[f] == 2;
    for (int v : j_.mesh.faces[f]) p->second.stays |= j_.fixed[v];
    p->second.area += area, p->second.box.extend(j_.mesh.face_box(f));
  }
  flap_.assign(j_.mesh.faces.size(), 0);
  std::set<int> roots;
  for (int f = 0; f < j_.mesh.face_count(); ++f) {
    const auto found = piece_of(f);
    if (found == severed.end() || found->second.stays) continue;
    const Piece& p = found->second;
    if (p.box.sizes().maxCoeff() >= max_gap_ && !(p.open && p.area < kSmall * whole[int(j_.tag[f])])) continue;
    flap_[f] = 1;
    roots.insert(found->first);
  }
  report_.pieces_dropped += int(roots.size());
  left_.erase(std::remove_if(left_.begin(), left_.end(),
                             [&](const mesh::Loop& l) { return roots.count(pieces.find(l.vertices[0])) > 0; }),
              left_.end());
}

/// What the cut made all around, and nothing is opposite: the surface stays closed.
/// @return the length of what is left open or was capped
double Stitching::close_or_leave() {
  double unmatched = 0;
  std::vector<mesh::Loop> capped;
  for (const mesh::Loop& loop : left_) {
    double made = 0;
    for_each_half_edge(loop, [&](const auto& e) { made += made_by_cut(e) ? length(e) : 0; });
    const bool ring = loop.closed && !any_own(loop);
    if (ring && std::all_of(loop.vertices.begin(), loop.vertices.end(), [&](int v) { return j_.closed[v]; }))
      capped.push_back(loop);
    else if (ring || !loop.closed || made > max_gap_)
      ++report_.loops_open;
    else
      continue;  // where two borders meet, what one is longer than the other
    unmatched += ring ? mesh::loop_length(j_.mesh, loop) : made;
  }
  report_.loops_capped += int(capped.size());
  cap(j_.mesh, capped, j_.like);
  j_.tag.resize(j_.mesh.faces.size(), 2);
  const std::size_t vertices = j_.mesh.vertices.size();
  // Borders that the models had and that were joined lie at the seam now.
  const auto side_of = [&](int v) { return j_.tag[j_.like[v]] == 1 ? kBorderB : kBorderA; };
  for (int f = 0; f < j_.mesh.face_count(); ++f)
    if (j_.tag[f] == 2)
      for (int v : j_.mesh.faces[f])
        if (v < int(j_.seam.size()) && !j_.seam[v]) j_.seam[v] = side_of(v);
  j_.seam.resize(vertices, kNoSeam), j_.fixed.resize(vertices, 0), j_.closed.resize(vertices, 1);
  j_.like.resize(vertices, j_.mesh.face_count() - 1);
  return unmatched;
}

template <class T>
void compact(std::vector<T>& array, const std::vector<int>& indices) {
  std::vector<T> out;
  for (int i : indices) out.push_back(array[i]);
  array.swap(out);
}

void Stitching::remove_flaps() {
  if (std::find(flap_.begin(), flap_.end(), 1) == flap_.end()) return;
  flap_.resize(j_.mesh.faces.size(), 0);
  std::vector<char> keep;
  for (char f : flap_) keep.push_back(!f);
  std::vector<int> old_vertex, old_face, number(j_.mesh.faces.size(), -1);
  j_.mesh = mesh::take_faces(j_.mesh, keep, &old_vertex, &old_face);
  compact(j_.tag, old_face);
  compact(j_.seam, old_vertex), compact(j_.fixed, old_vertex), compact(j_.closed, old_vertex);
  compact(j_.like, old_vertex);
  for (std::size_t f = 0; f < old_face.size(); ++f) number[old_face[f]] = int(f);
  for (int& f : j_.like) f = number[f];
  // Contours are as they were before the stitching, and so are their numbers.
  for (std::vector<mesh::Loop>* loops : {&j_.loops_a, &j_.loops_b, &j_.own_a, &j_.own_b}) loops->clear();
  j_.own.clear();
}

}  // namespace

double stitch_parts(Joined& j, double max_gap, SeamReport& report) { return Stitching(j, max_gap, report).run(); }

}  // namespace parts::seam
