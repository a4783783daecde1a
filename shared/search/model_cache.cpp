// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/search/model_cache.h"

#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "parts/base/error.h"
#include "parts/base/parallel.h"
#include "parts/base/tasks.h"

namespace parts::search {
namespace {

namespace fs = std::filesystem;

/// Changes with everything that changes what a file holds.
constexpr char kMagic[8] = {'r', 'a', 's', 't', 'e', 'r', '0', '1'};
constexpr std::size_t kHead = sizeof kMagic + sizeof(ModelCache::Key) + 2 * sizeof(std::uint64_t);

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

std::uint64_t hash_of(const std::string& text) {
  Hash h;
  h.add(text.data(), text.size());
  return h.value();
}

/// Of the whole of a small file, of 16 pieces of a large one: two scans of the
/// same size and time, put in each other's place, differ everywhere.
std::uint64_t content_hash(const std::string& path, std::uint64_t size) {
  constexpr std::uint64_t piece = 4096, pieces = 16;
  std::ifstream file(path, std::ios::binary);
  std::string bytes(piece, '\0');
  Hash h;
  const bool whole = size <= piece * pieces;
  for (std::uint64_t i = 0; i < pieces; ++i) {
    file.seekg(std::streamoff(whole ? i * piece : (size - piece) * i / (pieces - 1)));
    file.read(bytes.data(), std::streamsize(piece));
    h.add(bytes.data(), std::size_t(file.gcount()));
    if (!file) break;
  }
  return h.value();
}

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

std::string ModelCache::encode(const ModelRaster& r, const Key& key) {
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

std::unique_ptr<ModelRaster> ModelCache::decode(const std::string& bytes, const Key& key) {
  Taker in(bytes, 0);
  char magic[sizeof kMagic];
  Key found;
  std::uint64_t seal[2], counts[2];
  in.take(magic, sizeof magic);
  in.take(&found, 1);
  in.take(seal, 2);
  if (!in.good() || std::memcmp(magic, kMagic, sizeof magic) != 0 || !(found == key) || seal[0] != in.left()) return {};
  if (seal[1] != hash_of(bytes.substr(kHead))) return {};
  auto r = std::make_unique<ModelRaster>();
  in.take(r->origin.data(), 3);
  in.take(&r->size, 1);
  in.take(&r->area, 1);
  in.take(counts, 2);
  if (counts[0] == 0 || counts[0] >= RasterLevel::kFar || counts[1] != key.levels || counts[1] == 0 || counts[1] > 8)
    return {};
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

ModelCache::ModelCache(const io::ModelDatabase& database, const Options& options)
    : database_(database), options_(options) {
  std::error_code error;
  const fs::path path = database.path();
  folder_ = ((fs::is_directory(path, error) ? path : path.parent_path()) / ".model-cache").string();
}

std::string ModelCache::file(int model) const {
  const std::string name = fs::path(database_.file(model)).filename().string().substr(0, 80);
  std::error_code error;
  const fs::path from_here = fs::relative(
      database_.file(model), fs::path(folder_).parent_path().empty() ? "." : fs::path(folder_).parent_path(), error);
  char unique[32];
  const Key k = key(model);
  std::snprintf(unique, sizeof unique, ".%016llx",
                static_cast<unsigned long long>(
                    hash_of((error ? database_.file(model) : from_here.string()) + std::to_string(k.matrix))));
  return (fs::path(folder_) / (name + unique)).string();
}

ModelCache::Key ModelCache::key(int model) const {
  Key k;
  std::error_code error;
  k.size = std::uint64_t(fs::file_size(database_.file(model), error));
  k.time = std::uint64_t(fs::last_write_time(database_.file(model), error).time_since_epoch().count());
  k.content = content_hash(database_.file(model), k.size);
  Hash matrix;
  matrix.add(database_.matrix(model).data(), 16 * sizeof(double));
  k.matrix = matrix.value();
  k.levels = std::uint64_t(options_.levels);
  return k;
}

std::unique_ptr<ModelRaster> ModelCache::read(int model) const {
  if (!options_.files) return {};
  std::ifstream stream(file(model), std::ios::binary | std::ios::ate);
  const std::streamoff size = stream ? std::streamoff(stream.tellg()) : -1;
  if (size < std::streamoff(kHead) || size > (std::streamoff(1) << 30)) return {};
  std::string bytes(std::size_t(size), '\0');
  stream.seekg(0);
  if (!stream.read(bytes.data(), size)) return {};
  return decode(bytes, key(model));
}

bool ModelCache::write(int model, const ModelRaster& raster, const Key& key) const {
  std::error_code error;
  fs::create_directories(folder_, error);
  static std::atomic<unsigned> count{0};
  const std::string to = file(model);
  const std::string draft = to + ".part" + std::to_string(::getpid()) + "-" + std::to_string(++count);
  const std::string bytes = encode(raster, key);
  std::ofstream stream(draft, std::ios::binary);
  stream.write(bytes.data(), std::streamsize(bytes.size()));
  stream.close();
  if (stream) fs::rename(draft, to, error);
  if (stream && !error) return true;
  fs::remove(draft, error);
  return false;
}

void ModelCache::fill(Progress& progress) {
  const int n = database_.size();
  rasters_.clear();
  rasters_.resize(std::size_t(n));
  std::vector<std::string> skipped(static_cast<std::size_t>(n));
  std::atomic<int> made{0};
  std::atomic<bool> written{true};
  run_tasks(n, thread_count(options_.threads), progress, [&](int i, const std::function<void()>&) {
    std::unique_ptr<ModelRaster>& r = rasters_[std::size_t(i)];
    r = read(i);
    if (!r) try {
        const Key before = key(i);  // a model that is changed meanwhile must not look up to date
        r = std::make_unique<ModelRaster>(rasterize_model(database_.load(i), options_.levels));
        ++made;
        if (options_.files && written && !write(i, *r, before)) written = false;
      } catch (const UserError& e) {
        skipped[std::size_t(i)] = e.what();
      }
    if (r && n > options_.kept && r->levels.size() > 2) {
      r->levels.resize(2);
      r->levels.shrink_to_fit();
    }
  });
  made_ = made;
  progress.log("models rasterised: " + std::to_string(made_));
  for (int i = 0; i < n; ++i)
    if (!rasters_[std::size_t(i)]) progress.log("skipped: " + database_.name(i) + " (" + skipped[std::size_t(i)] + ")");
  if (!written) progress.log("cache: \"" + folder_ + "\" cannot be written, so the next search takes as long");
}

void ModelCache::complete(int model) {
  std::unique_ptr<ModelRaster>& r = rasters_[std::size_t(model)];
  if (!r || int(r->levels.size()) >= options_.levels) return;
  if (std::unique_ptr<ModelRaster> whole = read(model); whole && whole->samples.size() == r->samples.size()) {
    r->levels = std::move(whole->levels);
    return;
  }
  while (int(r->levels.size()) < options_.levels) add_level(*r);
}

}  // namespace parts::search
