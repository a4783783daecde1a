// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace parts::colorize {

/// How a colouring went.
struct ColorizeReport {
  std::vector<std::string> used;        ///< labels of the examples, the most similar first
  std::vector<double> shares;           ///< of the foreground that each of them gave
  std::vector<std::string> harmonized;  ///< labels of those whose colours were changed
  int left_out = 0;  ///< examples fewer than asked for, as the others' colours do not go with the first one's
  std::vector<std::vector<double>> objective;  ///< per level and iteration: mean log Sim (eq. 3)
  bool aligned = false;                        ///< the query was moved and scaled into the examples' frame
  double patch_distance = 0;                   ///< root mean square difference of patches, in standard deviations

  /// A bound that is not calibrated yet: members of a class mostly stay below it.
  bool trusted() const { return patch_distance < 1; }
};

}  // namespace parts::colorize
