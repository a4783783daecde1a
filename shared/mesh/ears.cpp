// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/ears.h"

#include <algorithm>
#include <queue>

#include "parts/mesh/predicates.h"

namespace parts::mesh {
namespace {

/// A polygon while its ears are cut, as a ring of the corners that are left.
class EarCutter {
 public:
  EarCutter(const std::vector<Vec3>& corners, const MayJoin& may_join);
  std::vector<Triangle> cut();

 private:
  struct Ear {
    double score;
    int corner;
    int stamp;  ///< of the corner when it was offered
    bool operator<(const Ear& e) const { return score != e.score ? score < e.score : corner > e.corner; }
  };

  void find_view();
  bool convex(int k) const { return turn_(prev_[k], k, next_[k]) > 0; }
  int turn_(int a, int b, int c) const { return side_ * turn(p_[a], p_[b], p_[c], axis_); }
  bool empty(int k) const;
  bool may_cut(int k) const { return !may_join_ || may_join_(prev_[k], next_[k]); }
  double score(int k) const;
  void offer(int k);
  bool offer_again();
  int take(std::priority_queue<Ear>& from);
  int best_of_four() const;
  void clip(int k);
  /// A triangle, from its first corner in the polygon on.
  void add(int a, int b, int c) {
    triangles_.push_back(a < b && a < c ? Triangle{a, b, c} : b < c ? Triangle{b, c, a} : Triangle{c, a, b});
  }

  const std::vector<Vec3>& p_;
  const MayJoin& may_join_;
  std::vector<int> prev_, next_, stamp_;
  int left_, first_ = 0;
  int axis_ = 0, side_ = 0;        // the view: along an axis, from where the polygon runs counter-clockwise
  std::vector<int> reflex_;        // by their place along the view's horizontal
  std::priority_queue<Ear> ears_;  // as seen in the view
  std::priority_queue<Ear> any_;
  std::vector<Triangle> triangles_;
};

EarCutter::EarCutter(const std::vector<Vec3>& corners, const MayJoin& may_join)
    : p_(corners), may_join_(may_join), stamp_(corners.size(), 0), left_(int(corners.size())) {
  for (int k = 0; k < left_; ++k) prev_.push_back((k + left_ - 1) % left_), next_.push_back((k + 1) % left_);
  find_view();
  for (int k = 0; k < left_; ++k) offer(k);
}

void EarCutter::find_view() {
  constexpr int kTooManyToLookInside = 20000;
  Vec3 normal = Vec3::Zero();  // Newell's
  for (int k = 0; k < left_; ++k) normal += (p_[k] - p_[0]).cross(p_[next_[k]] - p_[0]);
  normal.cwiseAbs().maxCoeff(&axis_);
  if (left_ > kTooManyToLookInside || !normal.allFinite() || normal[axis_] == 0) return;
  side_ = normal[axis_] > 0 ? 1 : -1;
  for (int k = 0; k < left_; ++k)
    if (!convex(k)) reflex_.push_back(k);
  const int x = (axis_ + 1) % 3;
  std::sort(reflex_.begin(), reflex_.end(), [&](int i, int j) { return p_[i][x] < p_[j][x]; });
}

/// No other corner lies in the ear or on its sides.
bool EarCutter::empty(int k) const {
  const int a = prev_[k], c = next_[k], x = (axis_ + 1) % 3, y = (axis_ + 2) % 3;
  const auto [west, east] = std::minmax({p_[a][x], p_[k][x], p_[c][x]});
  const auto [south, north] = std::minmax({p_[a][y], p_[k][y], p_[c][y]});
  auto r = std::lower_bound(reflex_.begin(), reflex_.end(), west, [&](int i, double at) { return p_[i][x] < at; });
  for (; r != reflex_.end() && p_[*r][x] <= east; ++r) {
    if (prev_[*r] < 0 || *r == a || *r == k || *r == c || p_[*r][y] < south || p_[*r][y] > north) continue;
    if (turn_(a, k, *r) >= 0 && turn_(k, c, *r) >= 0 && turn_(c, a, *r) >= 0) return false;
  }
  return true;
}

/// Convex and sharp first: the chord that replaces the corner is short.
double EarCutter::score(int k) const {
  const Vec3 &u = p_[prev_[k]], &v = p_[k], &w = p_[next_[k]];
  const double s = (side_ == 0 || turn_(prev_[k], k, next_[k]) >= 0 ? 1 : -1) -
                   (u - w).norm() / ((u - v).norm() + (w - v).norm() + 1e-300);
  return std::isfinite(s) ? s : -3;
}

void EarCutter::offer(int k) {
  const Ear ear{score(k), k, ++stamp_[k]};
  any_.push(ear);
  if (side_ != 0 && convex(k) && may_cut(k) && empty(k)) ears_.push(ear);
}

/// Where corners touch, an ear may come free without a neighbour's going.
bool EarCutter::offer_again() {
  int k = first_;
  for (int i = 0; i < left_; ++i, k = next_[k])
    if (convex(k) && may_cut(k) && empty(k)) ears_.push({score(k), k, stamp_[k]});
  return !ears_.empty();
}

/// The best corner that is still as it was when it was offered, or -1.
int EarCutter::take(std::priority_queue<Ear>& from) {
  while (!from.empty()) {
    const Ear e = from.top();
    from.pop();
    if (prev_[e.corner] >= 0 && stamp_[e.corner] == e.stamp && may_cut(e.corner)) return e.corner;
  }
  return -1;
}

/// The ear that leaves the shorter of the diagonals that lie inside, or -1.
int EarCutter::best_of_four() const {
  int best = -1;
  double least = 0;
  for (int k : {first_, next_[first_]}) {
    if (side_ == 0 || !may_cut(k) || !convex(k) || turn_(next_[k], next_[next_[k]], prev_[k]) <= 0) continue;
    const double d = (p_[prev_[k]] - p_[next_[k]]).norm();
    if (best < 0 || d < least) best = k, least = d;
  }
  return best;
}

void EarCutter::clip(int k) {
  const int a = prev_[k], c = next_[k];
  add(a, k, c);
  next_[a] = c, prev_[c] = a, prev_[k] = -1, first_ = a;
  --left_;
}

std::vector<Triangle> EarCutter::cut() {
  int rescans = side_ ? 4 : 0;  // few, so that the whole stays quadratic
  while (left_ > 3) {
    int k = left_ == 4 ? best_of_four() : -1;
    if (k < 0) k = take(ears_);
    if (k < 0 && rescans > 0) {
      --rescans;
      if (offer_again()) continue;
    }
    if (k < 0) k = take(any_);
    if (k < 0) return {};
    const int a = prev_[k], c = next_[k];
    clip(k);
    offer(a), offer(c);
  }
  if (left_ == 3) add(prev_[first_], first_, next_[first_]);
  return std::move(triangles_);
}

}  // namespace

std::vector<Triangle> cut_ears(const std::vector<Vec3>& corners, const MayJoin& may_join) {
  if (corners.size() < 3) return {};
  return EarCutter(corners, may_join).cut();
}

}  // namespace parts::mesh
