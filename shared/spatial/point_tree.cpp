// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/spatial/point_tree.h"

#include <cmath>
#include <limits>
#include <nanoflann.hpp>

namespace parts::spatial {
namespace {

/// The closest point, the first of several: nanoflann's own set keeps the one that it meets first.
struct First {
  using DistanceType = float;  // newer nanoflann asks for it

  int index = -1;
  float squared = std::numeric_limits<float>::max();

  std::size_t size() const { return index >= 0; }
  bool full() const { return true; }
  /// What is offered is below it, or below what it was a little before.
  float worstDist() const { return std::nextafter(squared, std::numeric_limits<float>::infinity()); }
  bool addPoint(float distance, int at) {
    if (distance < squared || (distance == squared && at < index)) squared = distance, index = at;
    return true;  // go on
  }
  void sort() {}  // there is but one
};

}  // namespace

template <int Dimensions>
struct PointTree<Dimensions>::Index {
  /// The points as nanoflann asks for them.
  struct Points {
    std::vector<Point> points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    float kdtree_get_pt(std::size_t index, std::size_t dimension) const { return points[index][dimension]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;  // it finds out by itself
    }
  };

  explicit Index(std::vector<Point> given)
      : points{std::move(given)}, tree(Dimensions, points, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}

  Points points;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, Dimensions, int> tree;
};

template <int Dimensions>
PointTree<Dimensions>::PointTree(std::vector<Point> points) : index_(std::make_unique<Index>(std::move(points))) {}

template <int Dimensions>
PointTree<Dimensions>::~PointTree() = default;

template <int Dimensions>
typename PointTree<Dimensions>::Nearest PointTree<Dimensions>::nearest(const Point& p) const {
  First found;
  index_->tree.findNeighbors(found, p.data(), {});
  return {found.index, found.squared};
}

template class PointTree<3>;
template class PointTree<6>;

}  // namespace parts::spatial
