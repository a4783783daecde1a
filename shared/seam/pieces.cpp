// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/pieces.h"

#include <algorithm>

#include "parts/seam/stitch.h"

namespace parts::seam {
namespace {

/// The vertices of one side's contours in a row, each a place.
class Side {
 public:
  explicit Side(const std::vector<Contour>& contours) : contours_(contours) {
    for (int l = 0; l < int(contours.size()); ++l)
      for (int at = 0; at < contours[l].loop.size(); ++at) places_.push_back({l, at});
    mate.assign(places_.size(), -1);
    filled.assign(places_.size(), 0);
  }
  int size() const { return int(places_.size()); }
  int vertex(int k) const { return loop(k).vertices[places_[k].at]; }
  /// The neighbours along the contour; -1 beyond the ends of a chain.
  int next(int k) const {
    const int at = places_[k].at + 1;
    return at < loop(k).size() ? k + 1 : loop(k).closed ? k + 1 - at : -1;
  }
  int before(int k) const {
    const int at = places_[k].at;
    return at > 0 ? k - 1 : loop(k).closed ? k - 1 + loop(k).size() : -1;
  }
  /// Whether the cut made the half-edge that leaves, or that enters.
  bool fresh_ahead(int k) const { return next(k) >= 0 && !contours_[places_[k].loop].own[places_[k].at]; }
  bool fresh_behind(int k) const { return before(k) >= 0 && fresh_ahead(before(k)); }
  bool fresh(int k) const { return fresh_ahead(k) || fresh_behind(k); }
  /// The next bridge along the contour; once around at most.
  int next_bridge(int k) const {
    do k = next(k);
    while (k >= 0 && mate[k] < 0);
    return k;
  }
  /// Places from one to another, once around if they are the same.
  std::vector<int> arc(int from, int to) const {
    std::vector<int> places{from};
    do places.push_back(from = next(from));
    while (from != to);
    return places;
  }

  /// Places from one on, along half-edges or against them, as far as the cut made
  /// them; none if it comes to a bridge before.
  std::vector<int> run(int k, bool ahead) const {
    std::vector<int> places{k};
    while (ahead ? fresh_ahead(k) : fresh_behind(k)) {
      k = ahead ? next(k) : before(k);
      if (mate[k] >= 0) return {};
      places.push_back(k);
    }
    return places;
  }

  std::vector<int> mate;     ///< per place: the other side's, across a bridge; or -1
  std::vector<char> filled;  ///< per place: the half-edge that leaves has a face opposite

 private:
  struct Place {
    int loop, at;
  };
  const mesh::Loop& loop(int k) const { return contours_[places_[k].loop].loop; }

  const std::vector<Contour>& contours_;
  std::vector<Place> places_;
};

class PieceZipper {
 public:
  PieceZipper(Mesh& mesh, const std::vector<Contour>& a, const std::vector<Contour>& b, double max_gap,
              const std::vector<int>& like)
      : mesh_(mesh), like_(like), max_gap_(max_gap), a_(a), b_(b), starts_(a_.size(), 0), ends_(a_.size(), 0) {}

  ZipperedPieces run() {
    bridge_nearest();
    for (int k = 0; k < a_.size(); ++k)
      if (a_.mate[k] >= 0) zipper_piece(k);
    for (int k = 0; k < a_.size(); ++k) {
      if (a_.mate[k] >= 0 && !starts_[k]) zipper_to_ends(k, true);
      if (a_.mate[k] >= 0 && !ends_[k]) zipper_to_ends(k, false);
    }
    pieces_.open = mesh::trace_loops(left_open());
    return std::move(pieces_);
  }

 private:
  const Vec3& at(const Side& side, int k) const { return mesh_.vertices[side.vertex(k)]; }
  std::vector<int> nearest(const Side& from, const Side& to) const;
  void bridge_nearest();
  void zipper_runs(const std::vector<int>& of_a, const std::vector<int>& of_b);
  void zipper_piece(int bridge);
  void zipper_to_ends(int bridge, bool ahead);
  bool faces(const Side& side, const std::vector<int>& arc, const Side& other, const std::vector<int>& opposite) const;
  std::vector<std::array<int, 2>> left_open() const;

  Mesh& mesh_;
  const std::vector<int>& like_;
  double max_gap_;
  Side a_, b_;
  std::vector<char> starts_, ends_;            ///< per place of a: a strip starts, ends at its bridge
  std::vector<std::array<int, 2>> ends_left_;  ///< half-edges across the ends of strips that end at no bridge
  ZipperedPieces pieces_;
};

/// Per place the nearest of the other side within max_gap, or -1. Two borders
/// that the inputs had are none of ours.
std::vector<int> PieceZipper::nearest(const Side& from, const Side& to) const {
  Box reach;
  for (int k = 0; k < to.size(); ++k) reach.extend(at(to, k));
  std::vector<char> fresh;
  for (int k = 0; k < to.size(); ++k) fresh.push_back(to.fresh(k));
  std::vector<int> found(from.size(), -1);
  for (int k = 0; k < from.size(); ++k) {
    const Vec3& x = at(from, k);
    if (reach.isEmpty() || reach.exteriorDistance(x) > max_gap_) continue;
    const bool any = from.fresh(k);
    double least = max_gap_ * max_gap_;
    for (int l = 0; l < to.size(); ++l)
      if (any || fresh[l])
        if (const double d = (at(to, l) - x).squaredNorm(); d < least) least = d, found[k] = l;
  }
  return found;
}

void PieceZipper::bridge_nearest() {
  const std::vector<int> to_b = nearest(a_, b_), to_a = nearest(b_, a_);
  for (int k = 0; k < a_.size(); ++k)
    if (to_b[k] >= 0 && to_a[to_b[k]] == k) a_.mate[k] = to_b[k], b_.mate[to_b[k]] = k;
}

/// Whether the part of an arc that the input had lies along the opposite arc.
bool PieceZipper::faces(const Side& side, const std::vector<int>& arc, const Side& other,
                        const std::vector<int>& opposite) const {
  for (std::size_t i = 0; i + 1 < arc.size(); ++i) {
    if (side.fresh_ahead(arc[i])) continue;
    for (int k : {arc[i], arc[i + 1]}) {
      const Vec3& x = at(side, k);
      double least = 1e300;
      for (std::size_t j = 0; j + 1 < opposite.size(); ++j) {
        const Vec3 &p = at(other, opposite[j]), d = at(other, opposite[j + 1]) - p;
        const double t = std::clamp((x - p).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0);
        least = std::min(least, (p + t * d - x).squaredNorm());
      }
      if (least > max_gap_ * max_gap_) return false;
    }
  }
  return true;
}

/// Zippers between a run of a's places and one of b's, b's against its half-edges.
void PieceZipper::zipper_runs(const std::vector<int>& of_a, const std::vector<int>& of_b) {
  std::vector<int> p, q;
  for (int place : of_a) p.push_back(a_.vertex(place));
  for (int place : of_b) q.push_back(b_.vertex(place));
  for (std::size_t i = 0; i + 1 < of_a.size(); ++i) a_.filled[of_a[i]] = 1;
  for (std::size_t i = 1; i < of_b.size(); ++i) b_.filled[of_b[i]] = 1;
  zipper_lines(mesh_, p, q, like_);
  ++pieces_.strips, pieces_.length += mesh::loop_length(mesh_, {p, false});
}

/// Zippers the piece between a bridge and a's next one, if b runs back from the
/// other to the one without a bridge between, and no more than one of the two
/// was in part a border before.
void PieceZipper::zipper_piece(int k) {
  const int next = a_.next_bridge(k);
  if (next < 0 || b_.next_bridge(a_.mate[next]) != a_.mate[k]) return;
  const std::vector<int> of_a = a_.arc(k, next);
  std::vector<int> of_b = b_.arc(a_.mate[next], a_.mate[k]);
  const auto all_fresh = [](const Side& side, const std::vector<int>& arc) {
    return std::all_of(arc.begin(), arc.end() - 1, [&](int p) { return side.fresh_ahead(p); });
  };
  const bool fresh_a = all_fresh(a_, of_a), fresh_b = all_fresh(b_, of_b);
  if ((!fresh_a && !fresh_b) || (!fresh_a && !faces(a_, of_a, b_, of_b)) || (!fresh_b && !faces(b_, of_b, a_, of_a)))
    return;
  std::reverse(of_b.begin(), of_b.end());
  zipper_runs(of_a, of_b);
  starts_[k] = 1, ends_[next] = 1;
}

/// Zippers from a bridge on to where on both sides what the cut made comes to
/// its end: there the inputs' borders go on, or a chain ends.
/// @param ahead  in a's direction, or against it
void PieceZipper::zipper_to_ends(int k, bool ahead) {
  std::vector<int> of_a = a_.run(k, ahead), of_b = b_.run(a_.mate[k], !ahead);
  if (of_a.empty() || of_b.empty() || of_a.size() + of_b.size() < 3) return;
  const int end_a = of_a.back(), end_b = of_b.back();
  if ((at(a_, end_a) - at(b_, end_b)).norm() > max_gap_) return;
  if (!ahead) std::reverse(of_a.begin(), of_a.end()), std::reverse(of_b.begin(), of_b.end());
  zipper_runs(of_a, of_b);
  (ahead ? starts_ : ends_)[k] = 1;
  std::array<int, 2> end{b_.vertex(end_b), a_.vertex(end_a)};
  if (!ahead) std::swap(end[0], end[1]);
  ends_left_.push_back(end);
}

/// The half-edges that faces have no opposite for: of the contours, and of
/// bridges that end a strip.
std::vector<std::array<int, 2>> PieceZipper::left_open() const {
  std::vector<std::array<int, 2>> open = ends_left_;
  for (const Side* side : {&a_, &b_})
    for (int k = 0; k < side->size(); ++k)
      if (!side->filled[k] && side->next(k) >= 0) open.push_back({side->vertex(k), side->vertex(side->next(k))});
  for (int k = 0; k < a_.size(); ++k) {
    if (starts_[k] == ends_[k]) continue;
    const int of_a = a_.vertex(k), of_b = b_.vertex(a_.mate[k]);
    open.push_back(starts_[k] ? std::array<int, 2>{of_a, of_b} : std::array<int, 2>{of_b, of_a});
  }
  return open;
}

}  // namespace

ZipperedPieces zipper_pieces(Mesh& mesh, const std::vector<Contour>& a, const std::vector<Contour>& b, double max_gap,
                             const std::vector<int>& like) {
  return PieceZipper(mesh, a, b, max_gap, like).run();
}

ZipperedPieces zipper_pieces(Mesh& mesh, const std::vector<mesh::Loop>& a, const std::vector<mesh::Loop>& b,
                             double max_gap, const std::vector<int>& like) {
  const auto fresh = [](const std::vector<mesh::Loop>& loops) {
    std::vector<Contour> contours;
    for (const mesh::Loop& l : loops) contours.push_back({l, std::vector<char>(l.vertices.size(), 0)});
    return contours;
  };
  return zipper_pieces(mesh, fresh(a), fresh(b), max_gap, like);
}

}  // namespace parts::seam
