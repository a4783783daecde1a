// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <vector>

#include "parts/synthesis/patches.h"

namespace parts::synthesis {

/// A window of an example: its centre.
struct Match {
  int example = -1, x = 0, y = 0;
  float distance = std::numeric_limits<float>::infinity();
};

/// One example at one level.
struct LevelExample {
  PatchPlane plane;
  std::vector<cv::Mat> bands;   ///< of the synthesised planes, 32F: Laplacian band (the coarsest: the plane itself)
  std::vector<cv::Mat> values;  ///< of the synthesised planes, 32F: Gaussian level
  cv::Mat coverage;             ///< 32F, 0..1
  bool active = true;
};

/// Candidates for windows: a kd-tree over principal components of the
/// examples' windows. Proposes only; never scores (He and Sun, "Computing
/// nearest-neighbor fields via propagation-assisted kd-trees", 2012).
class PatchTree {
 public:
  /// Looks at every step-th pixel of the active examples, step chosen so that
  /// there are at most `most` windows.
  /// @param share  of the principal components that are kept; 0 = the first 14
  PatchTree(const std::vector<LevelExample>& examples, const PatchLayout& layout, long most, double share, int threads);

  /// The leaf that a window falls into.
  int leaf(const Window& window) const;
  /// Its windows; distances are not set.
  const Match* begin(int leaf) const { return &entries_[leaves_[leaf]]; }
  const Match* end(int leaf) const { return &entries_[leaves_[leaf + 1]]; }
  bool empty() const { return entries_.empty(); }

 private:
  struct Node {
    int axis = -1;  ///< -1: a leaf
    float split = 0;
    int left = 0, right = 0;  ///< nodes; of a leaf: left is its number
  };
  void find_axes(const std::vector<LevelExample>& examples, const PatchLayout& layout, const std::vector<Match>& all,
                 double share, int threads);
  int build(std::vector<int>& order, int begin, int end, const std::vector<float>& rows, std::vector<Match>& all);
  float along(int axis, const Window& window) const;

  int axes_ = 0;
  std::vector<int> picks_;   ///< lanes of a window that the components look at
  std::vector<Lane> basis_;  ///< axes x (picks and one for the position), times the root of the weight
  std::vector<Node> nodes_;
  std::vector<Match> entries_;
  std::vector<int> leaves_;
};

/// Improves the matches of the query's windows; a match that is not beaten
/// stays, so no distance rises. Ties go to the lower example and pixel.
/// @param matches  a pixel; their distances are computed anew
/// @param tree     null: compares with every window (exact)
void search(const PatchPlane& query, const cv::Mat& coverage, const std::vector<LevelExample>& examples,
            const PatchLayout& layout, const PatchTree* tree, int threads, std::vector<Match>& matches);

}  // namespace parts::synthesis
