// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "parts/mend/scan.h"

namespace parts::mend {

/// A selection drawn on the screen goes through the model: it takes the back of
/// the head with the face, and eyeballs with their lids.
class Sheets {
 public:
  /// @param scan    kept by reference
  /// @param sheets  the faces of each piece of the selection; kept by reference
  Sheets(const Scan& scan, const std::vector<std::vector<int>>& sheets);

  /// Of sheets that are to be mended together, the most bent one is taken to be
  /// the flaw. Left out are those that lie behind it as it faces, and those of
  /// another component that is only partly selected.
  /// @param group  numbers of sheets
  /// @return for each of them, 1 = left out
  std::vector<char> not_meant(const std::vector<int>& group) const;

  /// Whether one sheet is the far side of the selection that made the other:
  /// in line with it, of the same outline, smoother, and all between is selected.
  bool is_far_side(int sheet, int of) const;

  /// Of a group the most bent one.
  int flaw_of(const std::vector<int>& group) const {
    return *std::max_element(group.begin(), group.end(), [&](int a, int b) { return bend_[a] < bend_[b]; });
  }

 private:
  const Scan& scan_;
  const std::vector<std::vector<int>>& sheets_;
  std::vector<double> bend_, area_;  ///< how far each is from flat; world units
  std::vector<int> selected_;        ///< faces, per component
  std::vector<int> sheet_of_;        ///< per face, -1 = none
};

}  // namespace parts::mend
