// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace parts::cut {

/// Number of bits set. Plain arithmetic: without the processor's own instruction,
/// which not every x86-64 has, the compiler's builtin is a call into a library.
inline int popcount(std::uint64_t w) {
  w -= w >> 1 & 0x5555555555555555;
  w = (w & 0x3333333333333333) + (w >> 2 & 0x3333333333333333);
  return int(((w + (w >> 4)) & 0x0f0f0f0f0f0f0f0f) * 0x0101010101010101 >> 56);
}

/// A set of voxels as one bit a voxel, with ranks: the n-th set voxel is node n.
class VoxelSet {
 public:
  VoxelSet() = default;
  explicit VoxelSet(std::size_t count) : words_((count + 63) / 64) {}

  bool has(std::size_t v) const { return words_[v >> 6] >> (v & 63) & 1; }
  void add(std::size_t v) { words_[v >> 6] |= std::uint64_t(1) << (v & 63); }
  /// As add(), from several threads at once.
  void add_shared(std::size_t v) { __atomic_fetch_or(&words_[v >> 6], std::uint64_t(1) << (v & 63), __ATOMIC_RELAXED); }
  VoxelSet& operator|=(const VoxelSet& other) {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= other.words_[i];
    return *this;
  }
  VoxelSet& operator&=(const VoxelSet& other) {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] &= other.words_[i];
    return *this;
  }

  /// To be called after the last change, before size(), node() and cells().
  void index() {
    rank_.resize(words_.size());
    size_ = 0;
    for (std::size_t i = 0; i < words_.size(); ++i) rank_[i] = int(size_), size_ += popcount(words_[i]);
  }
  long size() const { return size_; }
  /// The number of v among the set voxels, -1 where v is not one.
  int node(std::size_t v) const {
    const std::uint64_t w = words_[v >> 6], bit = std::uint64_t(1) << (v & 63);
    return w & bit ? rank_[v >> 6] + popcount(w & (bit - 1)) : -1;
  }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t i = 0; i < words_.size(); ++i)
      for (std::uint64_t w = words_[i]; w; w &= w - 1) visit(i * 64 + __builtin_ctzll(w));
  }
  std::vector<std::size_t> cells() const {
    std::vector<std::size_t> c;
    c.reserve(size_);
    for_each([&](std::size_t v) { c.push_back(v); });
    return c;
  }

 private:
  std::vector<std::uint64_t> words_;
  std::vector<int> rank_;
  long size_ = 0;
};

}  // namespace parts::cut
