// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/texture.h"

#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "parts/base/error.h"

namespace parts::render {
namespace {

namespace fs = std::filesystem;

/// What the host reads, which heeds neither alpha nor how a camera was held.
cv::Mat as_stored(const std::string& path) {
  try {
    return io::read_stored(path);
  } catch (const UserError&) {
    return {};
  }
}

bool has_picture(const fs::path& file, const cv::Mat& picture) {
  const cv::Mat there = as_stored(file.string());
  return there.size() == picture.size() && there.type() == picture.type() &&
         cv::norm(there, picture, cv::NORM_INF) == 0;
}

}  // namespace

bool shows_as_texture(const std::string& path, const io::Image& image) {
  if (!ends_in(path, {".png", ".jpg", ".jpeg", ".bmp"}) || image.has_alpha) return false;
  const cv::Mat stored = as_stored(path);
  if (stored.depth() != CV_8U || stored.size() != image.color.size()) return false;
  if (stored.channels() == 4 || stored.channels() == 2) return true;
  cv::Mat first, upright;  // it may have been turned by half a turn
  cv::extractChannel(stored, first, 0);
  cv::extractChannel(image.color, upright, 0);
  return cv::norm(first, upright, cv::NORM_INF) == 0;
}

cv::Mat extend_colors(const cv::Mat& color, const cv::Mat& mask) {
  cv::Mat out = color.clone(), distance, labels;
  if (cv::countNonZero(mask) == 0) return out;
  cv::distanceTransform(mask == 0, distance, labels, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Vec3b> of_label(std::size_t(mask.total()) + 1);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask.at<uchar>(y, x)) of_label[labels.at<int>(y, x)] = color.at<cv::Vec3b>(y, x);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (!mask.at<uchar>(y, x)) out.at<cv::Vec3b>(y, x) = of_label[labels.at<int>(y, x)];
  return out;
}

std::string add_texture(OutputFiles& files, const cv::Mat& color, const cv::Mat& mask, const TextureTarget& target) {
  const cv::Mat picture = extend_colors(color, mask);
  std::error_code error;
  if (!target.file.empty()) {
    for (const std::string& input : target.inputs)
      if (!input.empty() && fs::equivalent(input, target.file, error))
        throw UserError("The texture would replace the input \"" + input + "\"; give another TextureFile.");
    io::add_image(files, picture, target.file);
    return fs::absolute(target.file).lexically_normal().string();
  }
  const fs::path base = fs::absolute(target.beside);
  for (int n = 1;; ++n) {
    const std::string name = base.stem().string() + "_texture" + (n > 1 ? "_" + std::to_string(n) : "") + ".png";
    const fs::path file = (base.parent_path() / name).lexically_normal();
    if (files.reserve(file)) {
      io::add_image(files, picture, file.string());
      return file.string();
    }
    if (has_picture(file, picture)) return file.string();
  }
}

}  // namespace parts::render
