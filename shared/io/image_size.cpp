// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/image_size.h"

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace parts::io {
namespace {

/// Numbers of a byte order, anywhere in a file; 0 past its end.
class Bytes {
 public:
  Bytes(std::ifstream& file, bool big_endian) : file_(file), big_(big_endian) {}
  double number(std::int64_t at, int size) const {
    unsigned char b[8] = {};
    file_.clear();
    file_.seekg(at);
    file_.read(reinterpret_cast<char*>(b), size);
    if (!file_) return 0;
    std::uint64_t value = 0;
    for (int i = 0; i < size; ++i) value = value << 8 | b[big_ ? i : size - 1 - i];
    return double(value);
  }

 private:
  std::ifstream& file_;
  bool big_;
};

std::optional<ImageHead> checked(double width, double height, double bytes) {
  if (!(width > 0 && height > 0)) return {};
  return ImageHead{width, height, int(bytes < 1 ? 1 : bytes > 64 ? 64 : bytes)};
}

std::optional<ImageHead> png_head(std::ifstream& file) {
  const Bytes b(file, true);
  const int depth = int(b.number(24, 1)), kind = int(b.number(25, 1));
  const int channels = kind == 2 || kind == 3 ? 3 : kind == 4 ? 2 : kind == 6 ? 4 : 1;
  return checked(b.number(16, 4), b.number(20, 4), channels * (depth > 8 ? 2 : 1));
}

std::optional<ImageHead> jpeg_head(std::ifstream& file) {
  const Bytes b(file, true);
  std::int64_t at = 2;
  for (int segment = 0; segment < 10000; ++segment) {
    if (b.number(at, 1) != 0xFF) return {};
    const int marker = int(b.number(at + 1, 1));
    if (marker == 0xFF) {
      ++at;
      continue;
    }
    const bool frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (frame) return checked(b.number(at + 7, 2), b.number(at + 5, 2), 3);
    const double length = b.number(at + 2, 2);
    if (length < 2) return {};
    at += 2 + std::int64_t(length);
  }
  return {};
}

std::optional<ImageHead> tiff_head(std::ifstream& file, bool big_endian) {
  const Bytes b(file, big_endian);
  const bool large = b.number(2, 2) == 43;  // BigTIFF
  const std::int64_t directory = std::int64_t(large ? b.number(8, 8) : b.number(4, 4));
  const int entries = int(large ? b.number(directory, 8) : b.number(directory, 2));
  const int entry_size = large ? 20 : 12, value_at = large ? 12 : 8;
  double width = 0, height = 0, bits = 8, channels = 1;
  for (int i = 0; i < entries && i < 1000; ++i) {
    const std::int64_t at = directory + (large ? 8 : 2) + std::int64_t(entry_size) * i;
    const int tag = int(b.number(at, 2)), type = int(b.number(at + 2, 2));
    const double count = large ? b.number(at + 4, 8) : b.number(at + 4, 4);
    double value = b.number(at + value_at, type == 3 ? 2 : type == 16 ? 8 : 4);
    if (tag == 256) width = value;
    if (tag == 257) height = value;
    if (tag == 258)
      bits = type == 3 && count > (large ? 4 : 2) ? b.number(std::int64_t(b.number(at + value_at, 4)), 2) : value;
    if (tag == 277) channels = value;
  }
  return checked(width, height, bits / 8 * channels);
}

std::optional<ImageHead> bmp_head(std::ifstream& file) {
  const Bytes b(file, false);
  const auto integer = [&](int at) { return std::abs(double(std::int32_t(std::uint32_t(b.number(at, 4))))); };
  return checked(integer(18), integer(22), 4);
}

/// PBM, PGM, PPM ("P1" to "P6") and PFM ("PF", "Pf"): words between blanks.
std::optional<ImageHead> pnm_head(std::ifstream& file, char kind) {
  file.clear();
  file.seekg(2);
  double numbers[2] = {};
  for (double& number : numbers) {
    std::string word;
    while (file >> word && word[0] == '#') std::getline(file, word);
    number = std::atof(word.c_str());
  }
  return checked(numbers[0], numbers[1], kind == 'F' ? 12 : kind == 'f' ? 4 : 6);
}

}  // namespace

std::optional<ImageHead> read_image_head(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char head[4] = {};
  if (!file.read(head, 4)) return {};
  const std::string start(head, 4);
  if (start == "\x89PNG") return png_head(file);
  if (start.compare(0, 2, "\xFF\xD8") == 0) return jpeg_head(file);
  if (start.compare(0, 2, "II") == 0) return tiff_head(file, false);
  if (start.compare(0, 2, "MM") == 0) return tiff_head(file, true);
  if (start.compare(0, 2, "BM") == 0) return bmp_head(file);
  if (head[0] == 'P' && ((head[1] >= '1' && head[1] <= '6') || head[1] == 'F' || head[1] == 'f'))
    return pnm_head(file, head[1]);
  return {};
}

}  // namespace parts::io
