// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/search/raster_file.h"

#include <cmath>

namespace parts::search {
namespace {

/// Changes with everything that changes what a file holds.
constexpr char kMagic[8] = {'r', 'a', 's', 't', 'e', 'r', '0', '1'};
constexpr std::size_t kHead = sizeof kMagic + sizeof(RasterKey) + 2 * sizeof(std::uint64_t);

template <class T>
void append(std::string& bytes, const T* data, std::size_t n) {
  bytes.append(reinterpret_cast<const char*>(data), n * sizeof(T));
}

/// Takes values off the front of bytes; once they run out, everything is 0 and good() false.
class Taker {
 public:
  Taker(const std::string& bytes, std::size_t from) : bytes_(bytes), at_(from) {}
  template <class T>
  void take(T* data, std::size_t n) {
    std::memset(static_cast<void*>(data), 0, n * sizeof(T));
    if (!good_ || n > (bytes_.size() - at_) / sizeof(T)) return void(good_ = false);
    std::memcpy(static_cast<void*>(data), bytes_.data() + at_, n * sizeof(T));
    at_ += n * sizeof(T);
  }
  bool good() const { return good_; }
  bool done() const { return good_ && at_ == bytes_.size(); }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  const std::string& bytes_;
  std::size_t at_;
  bool good_ = true;
};

bool sound(const ModelRaster& r) {
  if (!r.origin.allFinite() || !(r.size > 0) || !(r.area > 0) || !std::isfinite(r.size) || !std::isfinite(r.area))
    return false;
  for (const RasterPoint& p : r.samples)
    if (!p.at.allFinite() || !p.normal.allFinite()) return false;
  for (const RasterLevel& l : r.levels) {
    if (!l.low.allFinite() || !(l.cell > 0) || !std::isfinite(l.cell)) return false;
    for (std::uint16_t s : l.nearest)
      if (s >= r.samples.size() && (s != RasterLevel::kFar || &l == &r.levels[0])) return false;
  }
  return true;
}

}  // namespace

std::uint64_t hash_of(const std::string& text) {
  Hash h;
  h.add(text.data(), text.size());
  return h.value();
}

std::string encode_raster(const ModelRaster& r, const RasterKey& key) {
  std::string body;
  append(body, r.origin.data(), 3);
  append(body, &r.size, 1);
  append(body, &r.area, 1);
  const std::uint64_t counts[2] = {r.samples.size(), r.levels.size()};
  append(body, counts, 2);
  append(body, r.samples.data(), r.samples.size());
  for (const RasterLevel& l : r.levels) {
    append(body, l.low.data(), 3);
    append(body, &l.cell, 1);
    append(body, l.dims.data(), 3);
    append(body, l.nearest.data(), l.nearest.size());
  }
  std::string bytes(kMagic, sizeof kMagic);
  append(bytes, &key, 1);
  const std::uint64_t seal[2] = {body.size(), hash_of(body)};
  append(bytes, seal, 2);
  return bytes + body;
}

std::unique_ptr<ModelRaster> decode_raster(const std::string& bytes, const RasterKey& key) {
  Taker in(bytes, 0);
  char magic[sizeof kMagic];
  RasterKey found;
  std::uint64_t seal[2];
  in.take(magic, sizeof magic);
  in.take(&found, 1);
  in.take(seal, 2);
  if (!in.good() || std::memcmp(magic, kMagic, sizeof magic) != 0 || !(found == key) || seal[0] != in.left()) return {};
  const std::string body = bytes.substr(kHead);
  if (seal[1] != hash_of(body)) return {};
  return decode_raster_body(body, key.levels);
}

std::unique_ptr<ModelRaster> decode_raster_body(const std::string& body, std::uint64_t levels) {
  Taker in(body, 0);
  std::uint64_t counts[2];
  auto r = std::make_unique<ModelRaster>();
  in.take(r->origin.data(), 3);
  in.take(&r->size, 1);
  in.take(&r->area, 1);
  in.take(counts, 2);
  if (counts[0] == 0 || counts[0] >= RasterLevel::kFar || counts[1] != levels || counts[1] == 0 || counts[1] > 8)
    return {};
  if (counts[0] > in.left() / sizeof(RasterPoint)) return {};
  r->samples.resize(counts[0]);
  in.take(r->samples.data(), r->samples.size());
  r->levels.resize(counts[1]);
  for (RasterLevel& l : r->levels) {
    in.take(l.low.data(), 3);
    in.take(&l.cell, 1);
    in.take(l.dims.data(), 3);
    for (int d : l.dims)
      if (d < 1 || d > 1024) return {};
    const std::size_t voxels = std::size_t(l.dims[0]) * l.dims[1] * l.dims[2];
    if (voxels > in.left()) return {};
    l.nearest.resize(voxels);
    in.take(l.nearest.data(), voxels);
  }
  if (!in.done() || !sound(*r)) return {};
  return r;
}

}  // namespace parts::search
