// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/mesh/loops.h"

namespace parts::mend {

/// Loose pieces of a scan within a hole: what a patch runs along gives way to
/// it, what it does not (an eyeball behind its lids) stays.
class Islands {
 public:
  /// @param scan  kept by reference
  /// @param size  of the region, world units
  Islands(const Mesh& scan, const mesh::Loop& rim, double size);

  bool any() const;
  const std::vector<char>& flags() const { return loose_; }  ///< per face of the scan
  /// Of the loose pieces, those that the patch runs along: flags per face.
  /// @param near   how far a piece may lie from it, world units
  /// @param count  out: how many
  std::vector<char> covered_by(const Mesh& patch, double near, int& count) const;

 private:
  const Mesh& scan_;
  std::vector<int> component_;
  std::vector<char> loose_;
};

}  // namespace parts::mend
