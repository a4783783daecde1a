// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/spatial/closest_face.h"

namespace parts::mend {

/// What a difference of normals counts, of the region's size: mouths find mouths, though other surface is nearer.
constexpr double kAlike = 0.2;

/// Where a model's vertices should go to lie on a scan, and how much each is to be believed.
struct Targets {
  std::vector<Vec3> point;
  std::vector<Vec3> normal;    ///< of the scan there
  std::vector<double> weight;  ///< 0 = no counterpart
  double rms = 0;              ///< weighted distance to the good surface, world units
  double share = 0;            ///< of the vertices that lie over good surface, those that have a counterpart
};

/// The part of a scan that models are fitted to.
class FitTarget {
 public:
  /// @param scan   kept by reference
  /// @param flaw   kept by reference; per face of the scan, 1 = damaged; empty = none is
  /// @param near   where it matters
  /// @param size   of the region, world units
  FitTarget(const Mesh& scan, const std::vector<char>& flaw, const Box& near, double size);

  bool empty() const { return closest_.empty(); }
  double size() const { return size_; }
  const Vec3& center() const { return center_; }  ///< of where it matters, world units
  bool flawed(int face) const { return !flaw_.empty() && flaw_[face]; }
  const spatial::ClosestFace& closest() const { return closest_; }
  const std::vector<spatial::Sample>& rim() const { return rim_; }  ///< good vertices near its borders

  /// Of the target's points the one nearest in place and normal together.
  struct Alike {
    spatial::Sample sample;
    int face = -1;  ///< a face it lies on
    bool border = false;
  };
  /// @param normals  what a difference of normals counts, world units
  std::vector<Alike> most_alike(const std::vector<spatial::Sample>& points, double normals, int threads) const;

 private:
  const std::vector<char>& flaw_;
  double size_;
  Vec3 center_;
  spatial::ClosestFace closest_;
  std::vector<spatial::Sample> rim_;
  std::vector<Alike> points_;
};

/// Pairs the vertices of a model with the nearest points of a scan.
class Matching {
 public:
  /// @param model, target  kept by reference
  Matching(const Mesh& model, const FitTarget& target, bool robust, int threads)
      : model_(model), target_(target), robust_(robust), threads_(threads) {}

  /// Pairs farther apart than `farthest`, on damaged faces, on the scan's border
  /// or on a side that faces away are none; of the rest, those that are out of line count
  /// less (Geman and McClure's estimator), if `robust`.
  /// @param at           the model's vertices now
  /// @param stride       > 1: only every so many-th vertex is paired
  /// @param normals      > 0: not the nearest point, but the one nearest in place
  ///                     and normal, of which a difference counts so much, world units
  Targets operator()(const std::vector<Vec3>& at, double farthest, int stride = 1, double normals = 0);

  /// A vertex that sees only the scan's border is asked for by the scan's
  /// vertices that see it: a rim stands out. @param targets  of the call before
  void ask_back(const std::vector<Vec3>& at, double farthest, Targets& targets) const;

 private:
  const Mesh& model_;
  const FitTarget& target_;
  double spread_ = 0, first_spread_ = 0;  ///< how far model and scan are usually apart: now, before they are fitted
  bool robust_;
  int threads_;
};

}  // namespace parts::mend
