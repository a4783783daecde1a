// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "database/closest_face.h"

namespace parts {

/// Where a model's vertices should go to lie on a scan, and how much each is to be believed.
struct Targets {
  std::vector<Vec3> point;
  std::vector<Vec3> normal;    ///< of the scan there
  std::vector<double> weight;  ///< 0 = no counterpart
  double rms = 0;              ///< weighted distance to the good surface, world units
  double share = 0;            ///< of the vertices that lie over good surface, those that have a counterpart
};

/// Pairs the vertices of a model with the nearest points of a scan.
class Matching {
 public:
  /// @param model, scan, flaw  kept by reference; flaw: per face of the scan, 1 = damaged; empty = none is
  /// @param size   of the region, world units
  Matching(const Mesh& model, const Mesh& scan, const std::vector<char>& flaw, double size, int threads);

  bool empty() const { return closest_.empty(); }

  /// Pairs farther apart than `farthest`, on the scan's border or on a side
  /// that faces away are none; of the rest, those that are out of line count
  /// less (Geman and McClure's estimator). A vertex that sees only the scan's
  /// border is asked for by the scan's vertices that see it: a rim stands out.
  /// @param at           the model's vertices now
  /// @param flaw_weight  of what lies on damaged faces
  Targets operator()(const std::vector<Vec3>& at, double farthest, double flaw_weight);

 private:
  void ask_back(const Mesh& moved, double farthest, double spread, Targets& t) const;

  const Mesh& model_;
  const std::vector<char>& flaw_;
  std::vector<Sample> rim_;  ///< good vertices of the scan near its borders
  ClosestFace closest_;
  double size_;
  double first_spread_ = 0;  ///< how far model and scan are usually apart, before they are fitted
  int threads_;
};

}  // namespace parts
