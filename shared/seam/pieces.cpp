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
    bridge_ends(a_, b_);
    bridge_ends(b_, a_);
    for (int k = 0; k < a_.size(); ++k)
      if (a_.mate[k] >= 0) zipper_from(k);
    pieces_.open = mesh::trace_loops(left_open());
    return std::move(pieces_);
  }

 private:
  const Vec3& at(const Side& side, int k) const { return mesh_.vertices[side.vertex(k)]; }
  std::vector<int> nearest(const Side& from, const Side& to) const;
  void bridge_nearest();
  void bridge_ends(Side& ending, Side& starting);
  void zipper_from(int bridge);
  bool faces(const Side& side, const std::vector<int>& arc, const Side& other, const std::vector<int>& opposite) const;
  std::vector<std::array<int, 2>> left_open() const;

  Mesh& mesh_;
  const std::vector<int>& like_;
  double max_gap_;
  Side a_, b_;
  std::vector<char> starts_, ends_;  ///< per place of a: a strip starts, ends at its bridge
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

/// Where on one side what the cut made comes to an end, and on the other it
/// starts, both behind the same last bridge, the ends are bridged too.
void PieceZipper::bridge_ends(Side& ending, Side& starting) {
  for (int k = 0; k < ending.size(); ++k) {
    if (ending.mate[k] >= 0 || !ending.fresh_behind(k) || ending.fresh_ahead(k)) continue;
    int m = k;
    do m = ending.fresh_behind(m) ? ending.before(m) : -1;
    while (m >= 0 && ending.mate[m] < 0 && m != k);
    if (m < 0 || ending.mate[m] < 0) continue;
    const int across = ending.mate[m];
    int l = across;
    while (starting.fresh_behind(l) && (l == across || starting.mate[l] < 0)) {
      l = starting.before(l);
      if (l == across) break;
    }
    if (l == across || starting.mate[l] >= 0 || (at(ending, k) - at(starting, l)).norm() > max_gap_) continue;
    ending.mate[k] = l, starting.mate[l] = k;
  }
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

/// Zippers the piece between a bridge and a's next one, if b runs back from the
/// other to the one without a bridge between.
void PieceZipper::zipper_from(int k) {
  const int next = a_.next_bridge(k);
  if (next < 0 || b_.next_bridge(a_.mate[next]) != a_.mate[k]) return;
  const std::vector<int> of_a = a_.arc(k, next), of_b = b_.arc(a_.mate[next], a_.mate[k]);
  const auto any_fresh = [](const Side& side, const std::vector<int>& arc) {
    return std::any_of(arc.begin(), arc.end() - 1, [&](int p) { return side.fresh_ahead(p); });
  };
  if (!any_fresh(a_, of_a) && !any_fresh(b_, of_b)) return;
  if (!faces(a_, of_a, b_, of_b) || !faces(b_, of_b, a_, of_a)) return;
  std::vector<int> p, q;
  for (int place : of_a) p.push_back(a_.vertex(place));
  for (int place : of_b) q.push_back(b_.vertex(place));
  for (std::size_t i = 0; i + 1 < of_a.size(); ++i) a_.filled[of_a[i]] = 1;
  for (std::size_t i = 0; i + 1 < of_b.size(); ++i) b_.filled[of_b[i]] = 1;
  std::reverse(q.begin(), q.end());
  zipper_lines(mesh_, p, q, like_);
  ++pieces_.strips, pieces_.length += mesh::loop_length(mesh_, {p, false});
  starts_[k] = 1, ends_[next] = 1;
}

/// The half-edges that faces have no opposite for: of the contours, and of
/// bridges that end a strip.
std::vector<std::array<int, 2>> PieceZipper::left_open() const {
  std::vector<std::array<int, 2>> open;
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
