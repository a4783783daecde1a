// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/image_head.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>

namespace parts::io {
namespace {

constexpr std::size_t kHead = 512;
constexpr std::string_view kBlanks = " \t\r\n";

/// Bytes anywhere in a file, fewer past its end.
using Source = std::function<std::string(std::uint64_t at, std::size_t n)>;

/// Numbers of a byte order, anywhere in a file; 0 past its end.
class Bytes {
 public:
  Bytes(const Source& source, bool big_endian, std::uint64_t origin = 0)
      : source_(source), big_(big_endian), origin_(origin) {}
  std::uint64_t number(std::uint64_t at, int size) const {
    if (at > UINT64_MAX - origin_) return 0;
    const std::string b = source_(origin_ + at, std::size_t(size));
    if (int(b.size()) < size) return 0;
    std::uint64_t value = 0;
    for (int i = 0; i < size; ++i) value = value << 8 | static_cast<unsigned char>(b[big_ ? i : size - 1 - i]);
    return value;
  }

 private:
  const Source& source_;
  bool big_;
  std::uint64_t origin_;
};

ImageHead head_of(double width, double height, double bytes) {
  ImageHead head;
  head.width = width, head.height = height;
  head.bytes = int(std::clamp(bytes, 1., 64.));
  return head;
}

/// A directory of a TIFF file, or of the EXIF block of others, which is one.
struct TiffDirectory {
  double width = 0, height = 0, bits = 8, channels = 1;
  int orientation = 1;
};

TiffDirectory tiff_directory(const Bytes& b) {
  const bool large = b.number(2, 2) == 43;  // BigTIFF
  const std::uint64_t directory = large ? b.number(8, 8) : b.number(4, 4);
  const std::uint64_t entries = large ? b.number(directory, 8) : b.number(directory, 2);
  const int entry_size = large ? 20 : 12, value_at = large ? 12 : 8;
  TiffDirectory d;
  for (std::uint64_t i = 0; i < entries && i < 1000; ++i) {
    const std::uint64_t at = directory + (large ? 8 : 2) + std::uint64_t(entry_size) * i;
    const auto tag = b.number(at, 2), type = b.number(at + 2, 2);
    const auto count = large ? b.number(at + 4, 8) : b.number(at + 4, 4);
    const double value = double(b.number(at + value_at, type == 3 ? 2 : type == 16 ? 8 : 4));
    if (tag == 256) d.width = value;
    if (tag == 257) d.height = value;
    if (tag == 258) {
      const bool elsewhere = type == 3 && count > (large ? 4 : 2);
      d.bits = elsewhere ? double(b.number(b.number(at + value_at, large ? 8 : 4), 2)) : value;
    }
    if (tag == 277) d.channels = value;
    if (tag == 274 && value >= 1 && value <= 8) d.orientation = int(value);
  }
  return d;
}

/// The orientation that an EXIF block states, which is a TIFF file of its own.
int exif_orientation(const Source& source, std::uint64_t at) {
  const std::string order = source(at, 2);
  if (order != "II" && order != "MM") return 1;
  return tiff_directory(Bytes(source, order == "MM", at)).orientation;
}

ImageHead png_head(const Source& source) {
  const Bytes b(source, true);
  const auto depth = b.number(24, 1), kind = b.number(25, 1);
  const int channels = kind == 2 || kind == 3 ? 3 : kind == 4 ? 2 : kind == 6 ? 4 : 1;
  ImageHead head = head_of(double(b.number(16, 4)), double(b.number(20, 4)), channels * (depth > 8 ? 2 : 1));
  std::uint64_t at = 8;
  for (int chunk = 0; chunk < 1000; ++chunk) {  // EXIF stands before or behind the image
    const std::string name = source(at + 4, 4);
    if (name.size() < 4 || name == "IEND") break;
    if (name == "eXIf") head.orientation = exif_orientation(source, at + 8);
    at += b.number(at, 4) + 12;
  }
  return head;
}

std::optional<ImageHead> jpeg_head(const Source& source) {
  const Bytes b(source, true);
  std::uint64_t at = 2;
  int orientation = 1;
  for (int segment = 0; segment < 10000; ++segment) {
    if (b.number(at, 1) != 0xFF) return {};
    const auto marker = b.number(at + 1, 1);
    if (marker == 0xFF) {
      ++at;
      continue;
    }
    const bool frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (frame) {
      ImageHead head = head_of(double(b.number(at + 7, 2)), double(b.number(at + 5, 2)), 3);
      head.orientation = orientation;
      return head;
    }
    if (marker == 0xE1 && source(at + 4, 6) == std::string("Exif\0\0", 6))
      orientation = exif_orientation(source, at + 10);
    const auto length = b.number(at + 2, 2);
    if (length < 2) return {};
    at += 2 + length;
  }
  return {};
}

ImageHead tiff_head(const Source& source, bool big_endian) {
  const TiffDirectory d = tiff_directory(Bytes(source, big_endian));
  return head_of(d.width, d.height, d.bits / 8 * d.channels);
}

ImageHead bmp_head(const Source& source) {
  const Bytes b(source, false);
  const auto integer = [&](int at) { return std::abs(double(std::int32_t(std::uint32_t(b.number(at, 4))))); };
  return head_of(integer(18), integer(22), 4);
}

/// PBM, PGM, PPM ("P1" to "P6") and PFM ("PF", "Pf"): words between blanks and comments.
ImageHead pnm_head(const Source& source) {
  const std::string text = source(0, kHead);
  double numbers[2] = {};
  std::size_t at = 2;
  for (double& number : numbers) {
    while (at < text.size() && (kBlanks.find(text[at]) != kBlanks.npos || text[at] == '#')) {
      if (text[at] == '#') at = std::min(text.find('\n', at), text.size() - 1);
      ++at;
    }
    const std::size_t end = std::min(text.find_first_of(" \t\r\n#", at), text.size());
    number = std::atof(text.substr(at, std::min<std::size_t>(end - at, 20)).c_str());
    at = end;
  }
  ImageHead head = head_of(numbers[0], numbers[1], text[1] == 'F' ? 12 : text[1] == 'f' ? 4 : 6);
  head.pfm = text[1] == 'F' || text[1] == 'f';
  return head;
}

std::optional<ImageHead> webp_head(const Source& source) {
  const Bytes b(source, false);
  const std::string kind = source(12, 4);
  if (kind == "VP8 ") return head_of(double(b.number(26, 2) & 0x3fff), double(b.number(28, 2) & 0x3fff), 3);
  if (kind == "VP8X") return head_of(double(b.number(24, 3) + 1), double(b.number(27, 3) + 1), 4);
  if (kind != "VP8L") return {};
  const auto bits = b.number(21, 4);
  return head_of(double((bits & 0x3fff) + 1), double((bits >> 14 & 0x3fff) + 1), 4);
}

std::optional<ImageHead> exr_head(const Source& source) {
  const Bytes b(source, false);
  const std::string head = source(0, 8 * kHead);
  const std::string name("dataWindow\0box2i\0", 17);
  const std::size_t at = head.find(name);
  if (at == head.npos) return {};
  const auto corner = [&](int i) {
    return double(std::int32_t(std::uint32_t(b.number(at + name.size() + 4 + 4 * std::size_t(i), 4))));
  };
  return head_of(corner(2) - corner(0) + 1, corner(3) - corner(1) + 1, 16);
}

std::optional<ImageHead> head_from(const Source& source) {
  const std::string start = source(0, 16);
  const auto starts = [&](const char* bytes, std::size_t n, std::size_t at = 0) {
    return start.compare(at, n, bytes, n) == 0;
  };
  std::optional<ImageHead> head;
  if (start.size() < 8) return {};
  if (starts("\x89PNG", 4)) head = png_head(source);
  if (starts("\xFF\xD8", 2)) head = jpeg_head(source);
  if (starts("II*", 3) || starts("II+", 3)) head = tiff_head(source, false);
  if (starts("MM", 2) && start[2] == 0) head = tiff_head(source, true);
  if (starts("BM", 2)) head = bmp_head(source);
  if (start[0] == 'P' && std::string_view("123456Ff").find(start[1]) != std::string_view::npos) head = pnm_head(source);
  if (starts("RIFF", 4) && start.size() >= 12 && starts("WEBP", 4, 8)) head = webp_head(source);
  if (starts("\x76\x2f\x31\x01", 4)) head = exr_head(source);
  if (!head || !(head->width > 0 && head->height > 0)) return {};
  return head;
}

}  // namespace

std::optional<ImageHead> read_image_head(const InputFile& file) {
  return head_from([&](std::uint64_t at, std::size_t n) { return file.read(at, n); });
}

std::optional<ImageHead> read_image_head(std::string_view bytes) {
  return head_from([&](std::uint64_t at, std::size_t n) {
    return at < bytes.size() ? std::string(bytes.substr(std::size_t(at), n)) : std::string();
  });
}

}  // namespace parts::io
