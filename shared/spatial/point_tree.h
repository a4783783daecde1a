// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <vector>

namespace parts::spatial {

/// Exact nearest neighbours among points of a few dimensions (3 or 6): a
/// kd-tree of nanoflann. Safe to ask from several threads.
template <int Dimensions>
class PointTree {
 public:
  using Point = std::array<float, Dimensions>;
  struct Nearest {
    int index;
    float squared;  ///< Euclidean distance, squared
  };

  /// @pre not empty, finite
  explicit PointTree(std::vector<Point> points);
  ~PointTree();

  /// Of points equally close the first.
  Nearest nearest(const Point& p) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

extern template class PointTree<3>;
extern template class PointTree<6>;

}  // namespace parts::spatial
