// SPDX-License-Identifier: GPL-3.0-or-later
// Images are encoded in memory, so that a full disk is noticed: imwrite() does not.
#include <new>
#include <opencv2/imgcodecs.hpp>

#include "parts/io/pfm.h"
#include "parts/io/raster_io.h"

namespace parts::io {
namespace {

void check_depth_ending(const std::string& path) {
  if (!ends_in(path, {".tif", ".tiff", ".pfm"}))
    throw UserError("The file \"" + path + "\" has no ending that depth can be written with; use .tif or .pfm.");
}

void check_image_ending(const std::string& path) {
  if (!ends_in(path, {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp"}))
    throw UserError("The file \"" + path +
                    "\" has no ending that an image can be written with; use .png, .jpg, .tif or .bmp.");
}

std::string encoded(const cv::Mat& image, const std::string& ending) {
  if (ending == ".pfm") return format_pfm(image);
  std::vector<uchar> bytes;
  try {
    if (cv::imencode(ending, image, bytes)) return {bytes.begin(), bytes.end()};
  } catch (const cv::Exception& e) {
    if (e.code == cv::Error::StsNoMem) throw std::bad_alloc();
  }
  throw UserError("An image of " + std::to_string(image.cols) + " x " + std::to_string(image.rows) +
                  " pixels cannot be written as " + ending + "; use .png, or make it smaller.");
}

}  // namespace

void check_depth_output(const std::string& path) {
  if (path.empty()) return;
  check_depth_ending(path);
  OutputFiles::check(path);
}

void check_image_output(const std::string& path) {
  if (path.empty()) return;
  check_image_ending(path);
  OutputFiles::check(path);
}

void add_depth(OutputFiles& files, const cv::Mat& depth, const std::string& path) {
  if (path.empty()) return;
  check_depth_ending(path);
  files.add(path, encoded(depth, lower_extension(path)));
}

void add_image(OutputFiles& files, const cv::Mat& image, const std::string& path) {
  if (path.empty()) return;
  check_image_ending(path);
  files.add(path, encoded(image, lower_extension(path)));
}

void write_depth(const cv::Mat& depth, const std::string& path) {
  check_depth_ending(path);
  write_file(path, encoded(depth, lower_extension(path)));
}

void write_image(const cv::Mat& image, const std::string& path) {
  check_image_ending(path);
  write_file(path, encoded(image, lower_extension(path)));
}

}  // namespace parts::io
