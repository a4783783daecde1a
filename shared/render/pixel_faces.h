// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace parts::render {

/// Triangles between the pixels of a raster: at most two in each block of four
/// neighbours a b / c d, on either diagonal. Pixels are numbered row by row;
/// triangles run counter-clockwise as seen.
class PixelFaces {
 public:
  using Face = std::array<int, 3>;

  /// @param joined  whether a face may have the side between two pixels
  /// @param step    the smaller, the rather is it a block's diagonal
  template <class Joined, class Step>
  PixelFaces(int width, int height, const Joined& joined, const Step& step)
      : width_(width), height_(height), blocks_(std::size_t(width) * height, 0) {
    for (int y = 0; y + 1 < height; ++y)
      for (int x = 0; x + 1 < width; ++x) {
        const int a = y * width + x, b = a + 1, c = a + width, d = c + 1;
        const bool ab = joined(a, b), ac = joined(a, c), bd = joined(b, d), cd = joined(c, d);
        const bool ad = joined(a, d), bc = joined(b, c);
        const int falling = ad ? (ac && cd) | (ab && bd) << 1 : 0, rising = bc ? (ac && ab) | (cd && bd) << 1 : 0;
        const int n = (falling & 1) + (falling >> 1), m = (rising & 1) + (rising >> 1);
        const bool rise = m > n || (m == n && m > 0 && step(b, c) < step(a, d));
        blocks_[a] = std::uint8_t(rise ? rising | kRising : falling);
      }
  }

  int width() const { return width_; }
  int pixels() const { return width_ * height_; }
  /// The triangles of a block, named by its first pixel. @return how many
  int of_block(int block, std::array<Face, 2>& faces) const {
    int n = 0;
    for (int which = 0; which < 2; ++which)
      if (blocks_[block] & 1 << which) faces[n++] = face(block, which);
    return n;
  }
  template <class Visit>
  void each(const Visit& visit) const {
    std::array<Face, 2> faces;
    for (int block = 0; block < pixels(); ++block)
      for (int i = 0, n = of_block(block, faces); i < n; ++i) visit(faces[i]);
  }
  long count() const;

  /// Calls visit(u, v) for each side that only one triangle has, as it runs there.
  void each_border(const std::function<void(int, int)>& visit) const;

  /// Drops triangles until no pixel joins several fans of them: all but the
  /// largest fan, or the first. @return how many
  int drop_pinches();
  /// Drops parts (joined by sides) without a pixel inside that touch a marked pixel. @return triangles dropped
  int drop_strips(const std::vector<char>& marked);
  /// The triangles around a pixel, as (block, which).
  struct Corner {
    int block, which;
  };
  std::vector<std::vector<Corner>> fans(int pixel) const;
  Face face(int block, int which) const {
    const int a = block, b = a + 1, c = a + width_, d = c + 1;
    if (blocks_[block] & kRising) return which == 0 ? Face{a, c, b} : Face{b, c, d};
    return which == 0 ? Face{a, c, d} : Face{a, d, b};
  }

 private:
  static constexpr std::uint8_t kRising = 4;  // the diagonal runs from b to c
  std::vector<std::uint8_t> side_counts() const;
  long side(int u, int v) const;
  std::vector<std::uint8_t> border_sides_at_pixels() const;

  int width_, height_;
  std::vector<std::uint8_t> blocks_;
};

}  // namespace parts::render
