// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "parts/base/files.h"

namespace parts::io {

/// A photograph or picture, height x width.
struct Image {
  cv::Mat color;           ///< 8UC3, BGR
  cv::Mat mask;            ///< 8U, 255 = foreground (alpha at least one half); all 255 without alpha
  bool has_alpha = false;  ///< the file had an alpha channel that hides something
  int orientation = 1;     ///< how the camera was held, by EXIF's numbers; 1: upright, or the file does not say
};

/// Upright turns the image as it was seen where the file says how the camera was
/// held; AsStored leaves its rows and columns as they are in the file, where
/// another raster of the same sensor has its own.
enum class Turn { Upright, AsStored };

/// Reads an image of 8 or 16 bits (or float from 0 to 1) a channel: grey, grey
/// with alpha, RGB or RGBA.
/// @throws UserError  the file is missing, unreadable, empty, larger than the
///                    memory or than its bytes warrant, or its alpha hides all of it
Image read_image(const std::string& path, Turn turn = Turn::Upright, const Poll& poll = {});

/// The rows, columns and colours as they are stored, for a texture: neither turned
/// nor masked. @return 8UC3, BGR
/// @throws UserError  as read_image
cv::Mat read_texture(const std::string& path);

/// The pixels as the file's format has them. @throws UserError  as read_image
cv::Mat read_stored(const std::string& path, const Poll& poll = {});

/// Reads a mask: an image whose bright half (or whose alpha, where it has one)
/// is the foreground. @return 8U, 0 or 255
/// @param size  that it must have; empty: any
/// @throws UserError  as read_image; another size; nothing is foreground
cv::Mat read_mask(const std::string& path, cv::Size size = {}, Turn turn = Turn::Upright);

/// Reads a depth raster: 32-bit float TIFF or PFM (also EXR where OpenCV can),
/// 16-bit PNG or TIFF. Depth grows away from the camera; 0, NaN and infinity
/// are background.
/// @param scale  world units that one unit of the file stands for; not 0
/// @return 32F, NaN = background
/// @throws UserError  the file is missing, unreadable, no depth raster, larger
///                    than the memory, or all of it is background
cv::Mat read_depth(const std::string& path, double scale = 1, const Poll& poll = {});

/// Writes a depth raster (32F; NaN = background) as .tif, .tiff or .pfm, as one of
/// several files or alone; an empty name is none.
/// @throws UserError  another ending, or the file cannot be written
void add_depth(OutputFiles& files, const cv::Mat& depth, const std::string& path);
void write_depth(const cv::Mat& depth, const std::string& path);

/// Writes an image (8U or 16U, 1, 3 or 4 channels, BGR) in the format of the
/// ending (.png, .jpg, .tif, .bmp), as add_depth does.
void add_image(OutputFiles& files, const cv::Mat& image, const std::string& path);
void write_image(const cv::Mat& image, const std::string& path);

/// Says before the work begins that such a file cannot be written; an empty name is none.
/// @throws UserError  the ending, the folder
void check_depth_output(const std::string& path);
void check_image_output(const std::string& path);

/// BGRA: the colour, with the mask as alpha.
cv::Mat with_alpha(const cv::Mat& color, const cv::Mat& mask);

/// The mask (8U, 0 or 255) of the pixels of a depth raster that have a depth.
cv::Mat depth_mask(const cv::Mat& depth);

}  // namespace parts::io
