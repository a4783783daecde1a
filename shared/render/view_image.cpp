// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/view_image.h"

#include <algorithm>
#include <cmath>

#include "parts/base/error.h"

namespace parts::render {
namespace {

constexpr double kMostOff = 0.01;

/// Rows of the depth, at the image's scale, to its rows.
double rows_ratio(cv::Size depth, cv::Size image) {
  return double(depth.height) * image.width / (double(depth.width) * image.height);
}

bool same_proportions(cv::Size depth, cv::Size image) {
  const double skew = std::abs(double(image.width) * depth.height - double(image.height) * depth.width);
  return skew <= std::max({image.width, image.height, depth.width, depth.height}) ||
         std::abs(rows_ratio(depth, image) - 1) <= kMostOff;
}

std::string pixels(cv::Size size) { return std::to_string(size.width) + " x " + std::to_string(size.height); }

}  // namespace

ViewImage read_view_image(const std::string& path, cv::Size depth) {
  ViewImage result;
  result.image = io::read_image(path, io::Turn::AsStored);
  if (result.image.orientation != 1) {
    result.held = ViewImage::Held::AsStored;
    if (!same_proportions(depth, result.image.color.size())) {
      io::Image upright = io::read_image(path);
      if (same_proportions(depth, upright.color.size())) {
        result.held = ViewImage::Held::Turned;
        result.image = std::move(upright);
      }
    }
  }
  const cv::Size size = result.image.color.size();
  if (!same_proportions(depth, size))
    throw UserError("The image has " + pixels(size) + " pixels and the depth raster " + pixels(depth) +
                    "; give an image of the same view, with the same proportions.");
  result.off = std::abs(rows_ratio(depth, size) - 1);
  return result;
}

void fit_texture(Mesh& mesh, cv::Size depth, cv::Size image) {
  const float ratio = float(rows_ratio(depth, image)), rim = 0.5f / float(image.height);
  if (ratio == 1) return;
  for (Wedges& w : mesh.wedges)
    for (Eigen::Vector2f& uv : w.uv) uv.y() = std::clamp(0.5f + (uv.y() - 0.5f) * ratio, rim, 1 - rim);
}

}  // namespace parts::render
