// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/raster_io.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "parts/base/memory.h"
#include "parts/io/image_head.h"
#include "parts/io/pfm.h"

namespace parts::io {
namespace {

constexpr double kMostPixels = double(1 << 15) * (1 << 15);  // what OpenCV's decoders take
constexpr double kFewPixels = 25e6;                          // decoded in well under a second, whatever they hold
constexpr double kDensest = 600;                             // decoded bytes of a byte, beyond that
constexpr double kMostBytes = std::numeric_limits<int>::max();

std::string named(const std::string& path) { return "The file \"" + path + "\" "; }

/// Refuses what does not fit, or takes long and holds nothing, before it is decoded.
void check_size(const std::string& path, const ImageHead& head, double file_bytes) {
  const double pixels = head.width * head.height, bytes = pixels * (2 * head.bytes + 8);
  const std::optional<double> free = available_memory();
  char size[64];
  std::snprintf(size, sizeof size, "%.0f x %.0f pixels", head.width, head.height);
  if (pixels > kMostPixels)
    throw UserError(named(path) + "says that it has " + size + ", which is more than can be read; make it smaller.");
  if (free && bytes > *free)
    throw UserError(named(path) + "has " + size + ", which need " + readable_size(bytes) + " of memory, and " +
                    readable_size(*free) + " are free; make it smaller.");
  if (file_bytes > kMostBytes)
    throw UserError(named(path) + "has " + readable_size(file_bytes) +
                    ", which is more than can be read; make it smaller.");
  if (pixels > kFewPixels && pixels * head.bytes > kDensest * file_bytes)
    throw UserError(named(path) + "says that its " + readable_size(file_bytes) + " hold " + size +
                    ", which no picture of something does; make it smaller.");
}

struct Decoded {
  cv::Mat pixels;  ///< as the format has them
  int orientation = 1;
};

cv::Mat decode(const std::string& bytes, const ImageHead& head) {
  if (head.pfm) return parse_pfm(bytes);
  try {
    const cv::Mat view(1, int(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
    return cv::imdecode(view, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& e) {
    if (e.code == cv::Error::StsNoMem) throw std::bad_alloc();
    return {};
  }
}

Decoded read_any(const std::string& path, const Poll& poll) {
  const InputFile file(path);
  if (file.size() == 0) throw UserError(named(path) + "is empty; save the image again.");
  const std::optional<ImageHead> head = read_image_head(file);
  cv::Mat image;
  if (head) {
    check_size(path, *head, double(file.size()));
    const std::string bytes = file.read_all(std::uint64_t(kMostBytes), poll);
    if (poll) poll();
    image = decode(bytes, *head);
  }
  if (image.empty())
    throw UserError(named(path) + "cannot be read as an image; check that it is whole, or save it as PNG or TIFF.");
  return {image, head->orientation};
}

/// The image as the camera saw it. EXIF 2.3, 4.6.4: 2 mirrored, 3 turned by half a
/// turn, 4 both, 5 to 8 with rows and columns exchanged.
cv::Mat upright(const cv::Mat& image, int orientation) {
  cv::Mat turned = image;
  if (orientation >= 5) cv::transpose(image, turned);
  const bool across = orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
  const bool down = orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
  if (across || down) cv::flip(turned, turned, across && down ? -1 : across ? 1 : 0);
  return turned;
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

}  // namespace

Image read_image(const std::string& path, Turn turn, const Poll& poll) {
  const Decoded stored = read_any(path, poll);
  const cv::Mat bytes =
      to_bytes(turn == Turn::Upright ? upright(stored.pixels, stored.orientation) : stored.pixels, path);
  std::vector<cv::Mat> planes;
  cv::split(bytes, planes);
  Image image;
  image.orientation = stored.orientation;
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

cv::Mat read_stored(const std::string& path, const Poll& poll) { return read_any(path, poll).pixels; }

cv::Mat read_texture(const std::string& path) {
  const cv::Mat bytes = to_bytes(read_any(path, {}).pixels, path);
  std::vector<cv::Mat> planes;
  cv::split(bytes, planes);
  if (planes.size() == 2 || planes.size() == 4) planes.pop_back();
  if (planes.size() == 1) planes.resize(3, planes[0]);
  if (planes.size() != 3)
    throw UserError(named(path) + "has " + std::to_string(planes.size()) + " channels; save it as grey, RGB or RGBA.");
  cv::Mat color;
  cv::merge(planes, color);
  return color;
}

cv::Mat read_mask(const std::string& path, cv::Size size, Turn turn) {
  const Image image = read_image(path, turn);
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

cv::Mat read_depth(const std::string& path, double scale, const Poll& poll) {
  cv::Mat raw = read_any(path, poll).pixels;
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
