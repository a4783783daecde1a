// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/pfm.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "parts/io/mesh_formats.h"

namespace parts::io {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

/// The next word of the head, after blanks and comments.
std::string_view next_word(std::string_view bytes, std::size_t& at) {
  while (at < bytes.size() && (kBlanks.find(bytes[at]) != kBlanks.npos || bytes[at] == '#')) {
    if (bytes[at] == '#') at = std::min(bytes.find('\n', at), bytes.size() - 1);
    ++at;
  }
  const std::size_t end = std::min(bytes.find_first_of(kBlanks, at), bytes.size()), from = at;
  at = end;
  return bytes.substr(from, end - from);
}

float float_at(const char* bytes, bool big_endian) {
  char raw[4];
  std::memcpy(raw, bytes, 4);
  if (big_endian) std::reverse(raw, raw + 4);
  float value;
  std::memcpy(&value, raw, 4);
  return value;
}

}  // namespace

cv::Mat parse_pfm(std::string_view bytes) {
  if (bytes.size() < 3 || bytes[0] != 'P' || (bytes[1] != 'f' && bytes[1] != 'F')) return {};
  const int channels = bytes[1] == 'F' ? 3 : 1;
  std::size_t at = 2;
  double width = 0, height = 0, scale = 0;
  try {
    width = formats::Scanner::to_number(next_word(bytes, at));
    height = formats::Scanner::to_number(next_word(bytes, at));
    scale = formats::Scanner::to_number(next_word(bytes, at));
  } catch (const formats::Malformed&) {
    return {};
  }
  if (at < bytes.size()) ++at;  // one blank, then the numbers
  const auto possible = [](double n) { return n >= 1 && n <= 1e6 && n == std::floor(n); };
  if (!possible(width) || !possible(height) || !std::isfinite(scale) || scale == 0) return {};
  if (width * height * channels * 4 > double(bytes.size() - at)) return {};
  cv::Mat image(int(height), int(width), CV_32FC(channels));
  for (int y = image.rows - 1; y >= 0; --y) {
    float* row = image.ptr<float>(y);
    for (int x = 0; x < image.cols; ++x, at += std::size_t(4 * channels))
      for (int c = 0; c < channels; ++c)
        row[x * channels + channels - 1 - c] = float_at(bytes.data() + at + 4 * c, scale > 0);
  }
  return image;
}

std::string format_pfm(const cv::Mat& image) {
  std::string out = "Pf\n" + std::to_string(image.cols) + " " + std::to_string(image.rows) + "\n-1\n";
  for (int y = image.rows - 1; y >= 0; --y)
    out.append(reinterpret_cast<const char*>(image.ptr<float>(y)), sizeof(float) * std::size_t(image.cols));
  return out;
}

}  // namespace parts::io
