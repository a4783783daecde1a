// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace parts::synthesis {

/// Windows are compared four channels at a time.
using Lane = Eigen::Array4f;

/// What all windows of a level have in common.
struct PatchLayout {
  int side = 5;                  ///< pixels
  int lanes = 1;                 ///< groups of four channels a pixel
  std::vector<float> gaussian;   ///< side * side, sums to 1
  std::vector<Lane> normalized;  ///< a lane group: 1 where the channel is normalised a window, else 0
  std::vector<Lane> factor;      ///< of normalised channels, after normalising: the weight's root
  std::vector<Lane> everywhere;  ///< 1 where a channel counts in the query's background too (the silhouette)
  std::vector<Lane> active;      ///< 0: the channel takes no part yet
  float position = 0;            ///< 1 / pixels that count 1
  int radius() const { return side / 2; }
  int window() const { return side * side * lanes; }  ///< lanes
};

/// An image of one level made ready for windows: channels side by side, scaled
/// by their weights, with a border, and the statistics of normalised channels.
struct PatchPlane {
  int width = 0, height = 0, border = 0, lanes = 1;
  std::vector<Lane> data;           ///< (height + 2 border) x (width + 2 border) x lanes
  std::vector<Lane> scale, offset;  ///< a pixel and lane: normalised = value * scale + offset
  std::vector<char> inside;         ///< a pixel: may be a window's centre
  Eigen::Vector2f centroid{0, 0};   ///< pixels

  int stride() const { return (width + 2 * border) * lanes; }
  long index(int x, int y) const { return long(y) * width + x; }
  const Lane* corner(int x, int y) const { return &data[long(y) * stride() + long(x) * lanes]; }
  Lane* at(int x, int y) { return &data[long(y + border) * stride() + long(x + border) * lanes]; }
};

/// @param channels  32F, all of one size and already scaled, at most lanes * 4; missing ones are 0
/// @param coverage  32F, 0..1: how much of each pixel is foreground
PatchPlane make_patch_plane(const std::vector<cv::Mat>& channels, const cv::Mat& coverage, const PatchLayout& layout);
/// Only where windows may be: for voting, not for comparing.
PatchPlane outline(const cv::Mat& coverage);
/// The window statistics anew, after data has changed.
void update_statistics(PatchPlane& plane, const cv::Mat& coverage, const PatchLayout& layout);

/// A query window, gathered once and compared with many.
struct Window {
  std::vector<Lane> value, weight;  ///< layout.window() each
  Eigen::Vector2f position;         ///< relative to the centroid, in units that count 1
};
void gather(const PatchPlane& plane, const cv::Mat& coverage, int x, int y, const PatchLayout& layout, Window& window);

/// The weighted squared distance (eq. 3's exponent, doubled); once it is at
/// least `enough` the rest is not looked at.
float distance(const Window& window, const PatchPlane& plane, int x, int y, const PatchLayout& layout, float enough);

}  // namespace parts::synthesis
