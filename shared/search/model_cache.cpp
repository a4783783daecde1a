// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/search/model_cache.h"

#include <atomic>
#include <chrono>
#include <set>

#include "parts/base/files.h"
#include "parts/base/parallel.h"
#include "parts/base/tasks.h"

namespace parts::search {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargest = std::uint64_t(1) << 30;  // bytes of a file
constexpr std::size_t kNameLength = 80, kHashDigits = 16;   // of a file's name
constexpr auto kDay = std::chrono::hours(24), kUnused = 30 * kDay;

/// Of the whole of a small file, of 16 pieces of a large one: two scans of the
/// same size and time, put in each other's place, differ everywhere.
std::uint64_t content_hash(const std::string& path, std::uint64_t size) {
  constexpr std::uint64_t piece = 4096, pieces = 16;
  const InputFile file(path);
  Hash h;
  const bool whole = size <= piece * pieces;
  for (std::uint64_t i = 0; i < pieces; ++i) {
    const std::string bytes = file.read(whole ? i * piece : (size - piece) * i / (pieces - 1), piece);
    h.add(bytes.data(), bytes.size());
    if (bytes.size() < piece) break;
  }
  return h.value();
}

/// NAME.0123456789abcdef, as file() makes them.
bool is_entry_name(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  return dot != name.npos && name.size() - dot - 1 == kHashDigits &&
         name.find_first_not_of("0123456789abcdef", dot + 1) == name.npos;
}

}  // namespace

ModelCache::ModelCache(const io::ModelDatabase& database, const Options& options)
    : database_(database), options_(options) {
  std::error_code error;
  const fs::path path = database.path();
  folder_ = ((fs::is_directory(path, error) ? path : path.parent_path()) / ".model-cache").string();
}

/// An entry of a model that lay beside the database and no longer does.
bool ModelCache::is_orphan(const fs::path& entry) const {
  const std::string name = entry.filename().string(), model = name.substr(0, name.size() - kHashDigits - 1);
  std::error_code error;
  if (model.size() >= kNameLength) return false;  // the name may have been cut off
  for (int i = 0; i < database_.size(); ++i)
    if (fs::path(database_.file(i)).filename() == model) return false;  // moved, say: its age counts
  return fs::is_directory(database_.path(), error) && !fs::exists(fs::path(database_.path()) / model, error);
}

std::string ModelCache::file(int model) const {
  const std::string name = fs::path(database_.file(model)).filename().string().substr(0, kNameLength);
  std::error_code error;
  const fs::path from_here = fs::relative(
      database_.file(model), fs::path(folder_).parent_path().empty() ? "." : fs::path(folder_).parent_path(), error);
  char unique[32];
  const RasterKey k = key(model);
  std::snprintf(unique, sizeof unique, ".%016llx",
                static_cast<unsigned long long>(
                    hash_of((error ? database_.file(model) : from_here.string()) + std::to_string(k.matrix))));
  return (fs::path(folder_) / (name + unique)).string();
}

RasterKey ModelCache::key(int model) const {
  RasterKey k;
  std::error_code error;
  k.size = std::uint64_t(fs::file_size(database_.file(model), error));
  k.time = std::uint64_t(fs::last_write_time(database_.file(model), error).time_since_epoch().count());
  try {
    k.content = content_hash(database_.file(model), k.size);
  } catch (const UserError&) {  // which loading it will say
  }
  Hash matrix;
  matrix.add(database_.matrix(model).data(), 16 * sizeof(double));
  k.matrix = matrix.value();
  k.levels = std::uint64_t(options_.levels);
  return k;
}

std::unique_ptr<ModelRaster> ModelCache::read(int model) const {
  const std::string path = file(model);
  std::error_code error;
  if (!options_.files || !fs::is_regular_file(path, error)) return {};
  std::string bytes;
  try {
    const InputFile stored(path);
    if (stored.size() > kLargest) return {};
    bytes = stored.read_all();
  } catch (const UserError&) {
    return {};
  }
  auto raster = decode_raster(bytes, key(model));
  const auto now = fs::file_time_type::clock::now();
  if (raster && now - fs::last_write_time(path, error) > kDay) fs::last_write_time(path, now, error);  // it was used
  return raster;
}

bool ModelCache::write(int model, const ModelRaster& raster, const RasterKey& key) const {
  std::error_code error;
  fs::create_directories(folder_, error);
  return write_cache_file(file(model), encode_raster(raster, key));
}

void ModelCache::prune() const {
  std::set<fs::path> ours;
  for (int i = 0; i < database_.size(); ++i) ours.insert(fs::path(file(i)).filename());
  const auto now = fs::file_time_type::clock::now();
  std::error_code error;
  std::vector<fs::path> old;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path name = entry->path().filename();
    std::error_code missing;
    const auto age = now - entry->last_write_time(missing);
    const bool stale = is_entry_name(name.string())
                           ? ours.count(name) == 0 && (age > kUnused || is_orphan(entry->path()))
                           : is_draft_name(name.string()) && age > kDay;
    if (!missing && stale && entry->is_regular_file(missing)) old.push_back(entry->path());
  }
  for (const fs::path& path : old) fs::remove(path, error);
}

void ModelCache::fill(Progress& progress) {
  const int n = database_.size();
  rasters_.clear();
  rasters_.resize(std::size_t(n));
  std::vector<std::string> skipped(static_cast<std::size_t>(n));
  std::atomic<int> made{0};
  std::atomic<bool> written{true};
  run_tasks(n, thread_count(options_.threads), progress, [&](int i, const std::function<void()>& poll) {
    std::unique_ptr<ModelRaster>& r = rasters_[std::size_t(i)];
    r = read(i);
    if (!r) try {
        const RasterKey before = key(i);  // a model that is changed meanwhile must not look up to date
        r = std::make_unique<ModelRaster>(rasterize_model(database_.load(i, poll), options_.levels));
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
  if (options_.files && made > 0) prune();
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
