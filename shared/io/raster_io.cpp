// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/raster_io.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "parts/base/error.h"
#include "parts/base/memory.h"
#include "parts/io/image_size.h"

namespace parts::io {
namespace {

namespace fs = std::filesystem;

constexpr double kMostPixels = double(1 << 15) * (1 << 15);  // what OpenCV's decoders take

std::string extension(const std::string& path) {
  std::string e = fs::path(path).extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return e;
}

std::string named(const std::string& path) { return "The file \"" + path + "\" "; }

std::string gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f GB", bytes / 1e9);
  return text;
}

/// Refuses what does not fit, before it is allocated.
void check_size(const std::string& path) {
  const std::optional<ImageHead> head = read_image_head(path);
  if (!head) return;
  const double pixels = head->width * head->height, bytes = pixels * (2 * head->bytes + 8), free = available_memory();
  char size[64];
  std::snprintf(size, sizeof size, "%.0f x %.0f pixels", head->width, head->height);
  if (pixels > kMostPixels)
    throw UserError(named(path) + "says that it has " + size + ", which is more than can be read; make it smaller.");
  if (free > 0 && bytes > free)
    throw UserError(named(path) + "has " + size + ", which need " + gigabytes(bytes) + " of memory, and " +
                    gigabytes(free) + " are free; make it smaller.");
}

/// The file as its format has it.
cv::Mat read_any(const std::string& path, bool upright = true) {
  std::error_code error;
  if (!fs::exists(path, error)) throw UserError(named(path) + "does not exist; check its name and folder.");
  if (!fs::is_regular_file(path, error))
    throw UserError(named(path) + "is a folder or a device; choose an image file.");
  if (fs::file_size(path, error) == 0) throw UserError(named(path) + "is empty; save the image again.");
  check_size(path);
  cv::Mat image;
  try {
    // Only photographs say how the camera was held, and only without IMREAD_UNCHANGED is that heeded.
    const std::string e = extension(path);
    const bool photograph = e == ".jpg" || e == ".jpeg";
    const int heed = upright ? 0 : cv::IMREAD_IGNORE_ORIENTATION;
    image = cv::imread(path, photograph ? cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH | heed : cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& e) {
    if (e.code == cv::Error::StsNoMem) throw std::bad_alloc();
  }
  if (image.empty())
    throw UserError(named(path) + "cannot be read as an image; check that it is whole, or save it as PNG or TIFF.");
  return image;
}

/// To 8 bits a channel.
cv::Mat to_bytes(const cv::Mat& image, const std::string& path) {
  cv::Mat bytes;
  if (image.depth() == CV_8U) return image;
  if (image.depth() == CV_16U) {
    image.convertTo(bytes, CV_8U, 1 / 257.);
    return bytes;
  }
  if (image.depth() != CV_32F && image.depth() != CV_64F)
    throw UserError(named(path) + "has numbers of a kind that is no image; save it with 8 or 16 bits a channel.");
  double low = 0, high = 0;
  cv::minMaxIdx(image.reshape(1), &low, &high);
  if (!(low >= -1e-3 && high <= 1.001))
    throw UserError(named(path) + "holds numbers beyond 0 to 1, as depth does; choose an image with colours.");
  image.convertTo(bytes, CV_8U, 255);
  return bytes;
}

UserError unwritable(const std::string& path) {
  return UserError(named(path) + "cannot be written; check its folder and the space left.");
}

/// OpenCV goes by the ending.
fs::path draft_of(const fs::path& target) {
  fs::path draft = target;
  return draft.replace_filename(target.stem().string() + ".part" + target.extension().string());
}

void write_draft(const cv::Mat& image, const std::string& path) {
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) throw unwritable(path);
  bool written = false;
  try {
    written = cv::imwrite(draft_of(path).string(), image);
  } catch (const cv::Exception& e) {
    if (e.code == cv::Error::StsNoMem) throw std::bad_alloc();
  }
  if (written) return;
  fs::remove(draft_of(path), error);
  throw unwritable(path);
}

void place_draft(const std::string& path) {
  std::error_code error, ignored;
  fs::rename(draft_of(path), path, error);
  if (!error) return;
  fs::remove(draft_of(path), ignored);
  throw unwritable(path);
}

template <size_t n>
bool ends_in(const std::string& path, const char* const (&endings)[n]) {
  return std::find(std::begin(endings), std::end(endings), extension(path)) != std::end(endings);
}

void check_depth_ending(const std::string& path) {
  if (!ends_in(path, {".tif", ".tiff", ".pfm"}))
    throw UserError(named(path) + "has no ending that depth can be written with; use .tif or .pfm.");
}

void check_image_ending(const std::string& path) {
  if (!ends_in(path, {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp"}))
    throw UserError(named(path) + "has no ending that an image can be written with; use .png, .jpg, .tif or .bmp.");
}

void check_folder(const std::string& path) {
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) throw unwritable(path);
  const fs::path draft = draft_of(path);
  const bool there = bool(std::ofstream(draft));
  fs::remove(draft, error);
  if (!there) throw unwritable(path);
}

}  // namespace

Image read_image(const std::string& path, bool upright) {
  const cv::Mat bytes = to_bytes(read_any(path, upright), path);
  std::vector<cv::Mat> planes;
  cv::split(bytes, planes);
  Image image;
  if (planes.size() == 2 || planes.size() == 4) {
    cv::compare(planes.back(), 128, image.mask, cv::CMP_GE);
    const int seen = cv::countNonZero(image.mask);
    if (seen == 0)
      throw UserError(named(path) + "is transparent everywhere; save it with its object opaque, or without alpha.");
    image.has_alpha = seen < int(image.mask.total());
    planes.pop_back();
  } else {
    image.mask = cv::Mat(bytes.size(), CV_8U, cv::Scalar(255));
  }
  if (planes.size() == 1) planes.resize(3, planes[0]);
  if (planes.size() != 3)
    throw UserError(named(path) + "has " + std::to_string(planes.size()) + " channels; save it as grey, RGB or RGBA.");
  cv::merge(planes, image.color);
  return image;
}

cv::Mat read_mask(const std::string& path, cv::Size size) {
  const Image image = read_image(path);
  if (!size.empty() && image.mask.size() != size)
    throw UserError("The mask \"" + path + "\" has " + std::to_string(image.mask.cols) + " x " +
                    std::to_string(image.mask.rows) + " pixels and its image " + std::to_string(size.width) + " x " +
                    std::to_string(size.height) + "; make the mask from that image.");
  cv::Mat mask = image.mask;
  if (!image.has_alpha) {
    cv::cvtColor(image.color, mask, cv::COLOR_BGR2GRAY);
    cv::compare(mask, 128, mask, cv::CMP_GE);
  }
  if (cv::countNonZero(mask) == 0)
    throw UserError("The mask \"" + path + "\" is black everywhere; paint the object white.");
  return mask;
}

cv::Mat read_depth(const std::string& path, double scale) {
  cv::Mat raw = read_any(path);
  if (raw.channels() > 1) {  // some programs write the one channel three times
    std::vector<cv::Mat> planes;
    cv::split(raw, planes);
    for (int c = 1; c < std::min(3, int(planes.size())); ++c)
      if (cv::norm(planes[0], planes[c], cv::NORM_INF) > 0) planes.clear();
    if (!planes.empty()) raw = planes[0];
  }
  if (raw.channels() > 1)
    throw UserError(named(path) + "has " + std::to_string(raw.channels()) +
                    " different channels and is no depth raster; use a float TIFF, a PFM or a 16-bit grey PNG.");
  if (raw.depth() == CV_8U)
    throw UserError(named(path) +
                    "has only 8 bits a pixel, too coarse for depth; use a float TIFF, a PFM or a 16-bit "
                    "grey PNG.");
  cv::Mat depth;
  raw.convertTo(depth, CV_32F);
  bool zero = true;
  long seen = 0;
  for (int y = 0; y < depth.rows; ++y) {
    float* z = depth.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) {
      zero = zero && z[x] == 0;
      const float scaled = z[x] == 0 ? 0.f : float(z[x] * scale);
      const bool background = z[x] == 0 || !std::isfinite(scaled);
      z[x] = background ? std::numeric_limits<float>::quiet_NaN() : scaled;
      seen += !background;
    }
  }
  if (zero)
    throw UserError(named(path) +
                    "holds nothing but zeros (an EXR file with only a Z channel reads like that); save "
                    "the depth as a float TIFF or PFM.");
  if (seen == 0)
    throw UserError(named(path) + "is background everywhere (0, infinite or not a number); save the depth again.");
  return depth;
}

void write_depth(const cv::Mat& depth, const std::string& path) {
  check_depth_ending(path);
  write_draft(depth, path);
  place_draft(path);
}

void write_image(const cv::Mat& image, const std::string& path) {
  check_image_ending(path);
  write_draft(image, path);
  place_draft(path);
}

void OutputFiles::check_depth(const std::string& path) {
  if (path.empty()) return;
  check_depth_ending(path);
  check_folder(path);
}

void OutputFiles::check_image(const std::string& path) {
  if (path.empty()) return;
  check_image_ending(path);
  check_folder(path);
}

OutputFiles::~OutputFiles() {
  std::error_code ignored;
  for (const std::string& path : paths_) fs::remove(draft_of(path), ignored);
}

void OutputFiles::depth(const cv::Mat& depth, const std::string& path) {
  if (path.empty()) return;
  check_depth_ending(path);
  write_draft(depth, path);
  paths_.push_back(path);
}

void OutputFiles::image(const cv::Mat& image, const std::string& path) {
  if (path.empty()) return;
  check_image_ending(path);
  write_draft(image, path);
  paths_.push_back(path);
}

void OutputFiles::commit() {
  for (const std::string& path : paths_) place_draft(path);
  paths_.clear();
}

cv::Mat with_alpha(const cv::Mat& color, const cv::Mat& mask) {
  std::vector<cv::Mat> planes;
  cv::split(color, planes);
  planes.push_back(mask);
  cv::Mat out;
  cv::merge(planes, out);
  return out;
}

cv::Mat depth_mask(const cv::Mat& depth) {
  cv::Mat mask;
  cv::compare(depth, depth, mask, cv::CMP_EQ);  // NaN is not equal to itself
  return mask;
}

}  // namespace parts::io
