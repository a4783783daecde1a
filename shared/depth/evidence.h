// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace parts::depth {

/// What speaks for and against a reconstruction. On a small scale, and apart
/// from it.
struct Evidence {
  /// How far the query's patches are from the examples', as a multiple of how far
  /// those of the strangest of a few members of the class are from the others'.
  double strangeness = 1;
  /// Intersection over union of the query's foreground and that of the example
  /// most like it, centroids aligned.
  double silhouette = 1;
  /// How differently two halves of the objects reconstruct it: the deviation of
  /// the difference, as a share of the depth range.
  double halves = 0;
  /// How much farther the patches are from the examples seen from elsewhere, 30
  /// degrees away: the least such quotient. Where the wrong view explains the
  /// image as well, none does. 0: not known, as views are stored.
  double view_margin = 0;
};

}  // namespace parts::depth
