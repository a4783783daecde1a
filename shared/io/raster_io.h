// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace parts::io {

/// A photograph or picture, height x width.
struct Image {
  cv::Mat color;           ///< 8UC3, BGR
  cv::Mat mask;            ///< 8U, 255 = foreground (alpha at least one half); all 255 without alpha
  bool has_alpha = false;  ///< the file had an alpha channel that hides something
};

/// Reads an image of 8 or 16 bits (or float from 0 to 1) a channel: grey, grey
/// with alpha, RGB or RGBA.
/// @param upright  turned as the file says that it was held; false: as it is stored
/// @throws UserError  the file is missing, unreadable, empty, larger than the
///                    memory, or its alpha hides all of it
Image read_image(const std::string& path, bool upright = true);

/// Reads a mask: an image whose bright half (or whose alpha, where it has one)
/// is the foreground. @return 8U, 0 or 255
/// @param size  that it must have; empty: any
/// @throws UserError  as read_image; another size; nothing is foreground
cv::Mat read_mask(const std::string& path, cv::Size size = {});

/// Reads a depth raster: 32-bit float TIFF or PFM (also EXR where OpenCV can),
/// 16-bit PNG or TIFF. Depth grows away from the camera; 0, NaN and infinity
/// are background.
/// @param scale  world units that one unit of the file stands for; not 0
/// @return 32F, NaN = background
/// @throws UserError  the file is missing, unreadable, no depth raster, larger
///                    than the memory, or all of it is background
cv::Mat read_depth(const std::string& path, double scale = 1);

/// Writes a depth raster (32F; NaN = background) as .tif, .tiff or .pfm. The
/// file appears, or replaces another, only once all of it is written.
/// @throws UserError  another ending, or the file cannot be written
void write_depth(const cv::Mat& depth, const std::string& path);

/// Writes an image (8U or 16U, 1, 3 or 4 channels, BGR) in the format of the
/// ending (.png, .jpg, .tif, .bmp), as write_depth does.
void write_image(const cv::Mat& image, const std::string& path);

/// Several such files: all are written, or none.
class OutputFiles {
 public:
  /// Says early that a file cannot be written; an empty name is none.
  /// @throws UserError  the ending, the folder
  static void check_depth(const std::string& path);
  static void check_image(const std::string& path);

  OutputFiles() = default;
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;
  ~OutputFiles();  ///< what was not put in place is gone

  /// Drafts beside the files; an empty name is none.
  /// @throws UserError  it cannot be written
  void depth(const cv::Mat& depth, const std::string& path);
  void image(const cv::Mat& image, const std::string& path);
  /// Puts all in place.
  void commit();

 private:
  std::vector<std::string> paths_;
};

/// BGRA: the colour, with the mask as alpha.
cv::Mat with_alpha(const cv::Mat& color, const cv::Mat& mask);

/// The mask (8U, 0 or 255) of the pixels of a depth raster that have a depth.
cv::Mat depth_mask(const cv::Mat& depth);

}  // namespace parts::io
