// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/pixel_faces.h"

#include <algorithm>

#include "parts/base/disjoint_sets.h"

namespace parts::render {

long PixelFaces::count() const {
  long n = 0;
  for (std::uint8_t b : blocks_) n += (b & 1) + (b >> 1 & 1);
  return n;
}

/// The number of the side between two neighbouring pixels: four a pixel, to the
/// right, down, down right, down left.
long PixelFaces::side(int u, int v) const {
  if (u > v) std::swap(u, v);
  const int step = v - u;
  const int kind = step == 1 && width_ > 1 ? 0 : step == width_ ? 1 : step == width_ + 1 ? 2 : 3;
  return 4L * u + kind;
}

std::vector<std::uint8_t> PixelFaces::side_counts() const {
  std::vector<std::uint8_t> counts(4 * std::size_t(pixels()), 0);
  each([&](const Face& f) {
    for (int k = 0; k < 3; ++k) ++counts[side(f[k], f[(k + 1) % 3])];
  });
  return counts;
}

void PixelFaces::each_border(const std::function<void(int, int)>& visit) const {
  const std::vector<std::uint8_t> counts = side_counts();
  each([&](const Face& f) {
    for (int k = 0; k < 3; ++k)
      if (counts[side(f[k], f[(k + 1) % 3])] == 1) visit(f[k], f[(k + 1) % 3]);
  });
}

std::vector<std::uint8_t> PixelFaces::border_sides_at_pixels() const {
  std::vector<std::uint8_t> sides(std::size_t(pixels()), 0);
  each_border([&](int u, int v) { ++sides[u], ++sides[v]; });
  return sides;
}

std::vector<std::vector<PixelFaces::Corner>> PixelFaces::fans(int pixel) const {
  std::vector<Corner> corners;
  const int x = pixel % width_, y = pixel / width_;
  for (int by = std::max(0, y - 1); by <= std::min(height_ - 2, y); ++by)
    for (int bx = std::max(0, x - 1); bx <= std::min(width_ - 2, x); ++bx)
      for (int which = 0; which < 2; ++which) {
        const int block = by * width_ + bx;
        if (!(blocks_[block] & 1 << which)) continue;
        const Face f = face(block, which);
        if (std::find(f.begin(), f.end(), pixel) != f.end()) corners.push_back({block, which});
      }
  const auto joined = [&](const Corner& a, const Corner& b) {  // by a side at the pixel
    const Face f = face(a.block, a.which), g = face(b.block, b.which);
    return std::count_if(f.begin(), f.end(), [&](int p) { return std::find(g.begin(), g.end(), p) != g.end(); }) > 1;
  };
  std::vector<std::vector<Corner>> fans;
  std::vector<char> done(corners.size(), 0);
  for (std::size_t first = 0; first < corners.size(); ++first) {
    if (done[first]) continue;
    std::vector<std::size_t> members = {first};
    done[first] = 1;
    for (std::size_t m = 0; m < members.size(); ++m)
      for (std::size_t c = 0; c < corners.size(); ++c)
        if (!done[c] && joined(corners[members[m]], corners[c])) done[c] = 1, members.push_back(c);
    fans.emplace_back();
    for (std::size_t m : members) fans.back().push_back(corners[m]);
  }
  return fans;
}

int PixelFaces::drop_pinches() {
  int dropped = 0;
  std::vector<int> doubtful;
  const std::vector<std::uint8_t> sides = border_sides_at_pixels();
  for (int p = 0; p < pixels(); ++p)
    if (sides[p] > 2) doubtful.push_back(p);
  while (!doubtful.empty()) {
    const int p = doubtful.back();
    doubtful.pop_back();
    std::vector<std::vector<Corner>> around = fans(p);
    if (around.size() < 2) continue;
    const auto largest = std::max_element(around.begin(), around.end(),
                                          [](const auto& a, const auto& b) { return a.size() < b.size(); });
    for (auto fan = around.begin(); fan != around.end(); ++fan) {
      if (fan == largest) continue;
      for (const Corner& c : *fan) {
        for (int q : face(c.block, c.which)) doubtful.push_back(q);
        blocks_[c.block] = std::uint8_t(blocks_[c.block] & ~(1 << c.which));
        ++dropped;
      }
    }
  }
  return dropped;
}

int PixelFaces::drop_strips(const std::vector<char>& marked) {
  DisjointSets parts(2 * pixels());  // triangle `which` of a block is 2 block + which
  const auto each_numbered = [&](const auto& visit) {
    for (int block = 0; block < pixels(); ++block)
      for (int which = 0; which < 2; ++which)
        if (blocks_[block] & 1 << which) visit(2 * block + which, face(block, which));
  };
  std::vector<int> first(4 * std::size_t(pixels()), -1);  // triangle at a side
  each_numbered([&](int number, const Face& f) {
    for (int k = 0; k < 3; ++k) {
      int& at = first[side(f[k], f[(k + 1) % 3])];
      if (at < 0)
        at = number;
      else
        parts.unite(at, number);
    }
  });
  std::vector<char> has_inside(2 * std::size_t(pixels()), 0), is_marked = has_inside;
  const std::vector<std::uint8_t> sides = border_sides_at_pixels();
  each_numbered([&](int number, const Face& f) {
    const int part = parts.find(number);
    for (int p : f) {
      if (sides[p] == 0) has_inside[part] = 1;
      if (marked[p]) is_marked[part] = 1;
    }
  });
  int dropped = 0;
  each_numbered([&](int number, const Face&) {
    const int part = parts.find(number);
    if (has_inside[part] || !is_marked[part]) return;
    std::uint8_t& block = blocks_[number / 2];
    block = std::uint8_t(block & ~(1 << number % 2));
    ++dropped;
  });
  return dropped;
}

}  // namespace parts::render
