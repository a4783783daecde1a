// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>

#include "parts/search/model_raster.h"

/// The bytes of the cache's files.
namespace parts::search {

/// What a rasterisation was made from.
struct RasterKey {
  std::uint64_t size = 0, time = 0, content = 0, matrix = 0, levels = 0;
  bool operator==(const RasterKey& k) const {
    return size == k.size && time == k.time && content == k.content && matrix == k.matrix && levels == k.levels;
  }
};

std::string encode_raster(const ModelRaster& raster, const RasterKey& key);

/// Nothing if the bytes are not exactly what encode_raster() makes for that key.
std::unique_ptr<ModelRaster> decode_raster(const std::string& bytes, const RasterKey& key);

/// The same of what follows the key and the seal, which vouch for nothing.
std::unique_ptr<ModelRaster> decode_raster_body(const std::string& body, std::uint64_t levels);

/// FNV-1a, eight bytes at a time: against damage, not against malice.
class Hash {
 public:
  void add(const void* data, std::size_t n) {
    const char* bytes = static_cast<const char*>(data);
    for (; n >= 8; n -= 8, bytes += 8) {
      std::uint64_t word;
      std::memcpy(&word, bytes, 8);
      mix(word);
    }
    for (; n > 0; --n, ++bytes) mix(static_cast<unsigned char>(*bytes));
  }
  std::uint64_t value() const { return state_; }

 private:
  void mix(std::uint64_t word) {
    state_ = (state_ ^ word) * 0x100000001b3ull;
    state_ ^= state_ >> 29;
  }
  std::uint64_t state_ = 0xcbf29ce484222325ull;
};

std::uint64_t hash_of(const std::string& text);

}  // namespace parts::search
