// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "parts/examples/example.h"
#include "parts/synthesis/patch_image.h"

namespace parts::colorize {

/// Several views of one surface as tiles of one image, so that they are
/// synthesised together; and where they show the same point. A tile holds a part
/// of a view's image.
class ViewSheet {
 public:
  struct Tile {
    render::Camera camera;
    cv::Mat depth;    ///< 32F of the whole view, NaN = background
    cv::Mat normal;   ///< 32FC3 of the whole view: of the surface, world frame, towards the camera
    cv::Mat trust;    ///< 32F of the whole view, 0..1: falls towards silhouettes and depth jumps
    cv::Rect part;    ///< of the view's image that is in the sheet
    cv::Point place;  ///< of the part's first pixel in the sheet
  };

  ViewSheet() = default;
  /// @param views   of one surface
  /// @param parts   of their images, a rectangle each
  /// @param levels  of the pyramids that are made of the sheet
  /// @param gap     pixels of the coarsest level between tiles
  ViewSheet(const std::vector<examples::Example>& views, const std::vector<cv::Rect>& parts, int levels, int gap,
            int threads);

  cv::Size size() const { return size_; }
  const std::vector<Tile>& tiles() const { return tiles_; }

  /// The sheet of the parts of whole images, one a view.
  synthesis::PatchImage assemble(const std::vector<synthesis::PatchImage>& images) const;

  /// What the views show of a point: the mean of all that see it, each by how
  /// directly it does.
  /// @param planes  of the sheet at a level (see Agreement)
  /// @param normal  of the surface there; zero: not known
  /// @param value   one a plane; untouched where no view sees it
  /// @return how well it is seen: 0 = not at all, 1 = by one view from the front
  float look(const std::vector<cv::Mat>& planes, int level, const Vec3& point, const Vec3& normal, float* value) const;

  /// An Agreement: every pixel gets what look() says of its point.
  void agree(int level, std::vector<cv::Mat>& planes) const;

 private:
  std::vector<Tile> tiles_;
  cv::Size size_;
  int threads_ = 0;
};

}  // namespace parts::colorize
