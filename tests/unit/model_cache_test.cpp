// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/search/model_cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "parts/io/mesh_io.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace parts {
namespace {

namespace fs = std::filesystem;

using test::contents;

bool same(const search::ModelRaster& a, const search::ModelRaster& b) {
  const search::RasterKey key{1, 2, 3, 4, a.levels.size()};
  return search::encode_raster(a, key) == search::encode_raster(b, key);
}

class Cache : public test::Folder {
 protected:
  void SetUp() override {
    for (unsigned i = 0; i < 3; ++i) put("m" + std::to_string(i) + ".ply", i);
  }
  void TearDown() override { fs::permissions(folder, fs::perms::owner_all); }
  void put(const std::string& name, unsigned seed) const {
    io::write_mesh(test::noisy_sphere(Vec3(1, 2, 3), 2, 3, 0.3, seed), (folder / name).string());
  }
  /// A fill by a new run; how many it had to make.
  int fill(int levels = 2, bool files = true, int kept = 100) {
    database_ = std::make_unique<io::ModelDatabase>(folder.string(), progress_);
    const io::ModelDatabase& database = *database_;
    cache_ = std::make_unique<search::ModelCache>(database, search::ModelCache::Options{levels, files, 2, kept});
    cache_->fill(progress_);
    for (int i = 0; i < database.size(); ++i)
      if (cache_->raster(i)) {
        EXPECT_TRUE(
            same(*cache_->raster(i), search::rasterize_model(database.load(i), int(cache_->raster(i)->levels.size()))));
      }
    return cache_->made();
  }
  fs::path file(int i) const {
    std::vector<fs::path> files;
    for (const auto& e : fs::directory_iterator(folder / ".model-cache")) files.push_back(e.path());
    std::sort(files.begin(), files.end());
    return files.at(std::size_t(i));
  }
  int file_count() const {
    return int(std::distance(fs::directory_iterator(folder / ".model-cache"), fs::directory_iterator()));
  }

  bool fills_undisturbed() try {
    Progress silent;
    const io::ModelDatabase database(folder.string(), silent);
    bool good = true;
    for (int k = 0; k < 3; ++k) {
      search::ModelCache cache(database, {2, true, 1});
      cache.fill(silent);
      for (int m = 0; m < 3; ++m) good = good && cache.raster(m);
      std::error_code error;
      if (k == 0) fs::remove_all(folder / ".model-cache", error);
    }
    return good;
  } catch (...) {
    return false;
  }

  std::vector<std::string> log_;
  Progress progress_{{}, [this](const std::string& line) { log_.push_back(line); }};
  std::unique_ptr<io::ModelDatabase> database_;
  std::unique_ptr<search::ModelCache> cache_;
};

TEST_F(Cache, IsMadeOnce) {
  EXPECT_EQ(fill(), 3);
  EXPECT_EQ(file_count(), 3);
  EXPECT_EQ(fill(), 0);
  EXPECT_EQ(fill(3), 3) << "other levels";
  EXPECT_EQ(fill(3), 0);
}

TEST_F(Cache, IsMadeAgainForAnotherModel) {
  fill();
  put("m1.ply", 77);
  EXPECT_EQ(fill(), 1);
  // The same size, the same time, another surface.
  const auto time = fs::last_write_time(folder / "m1.ply");
  put("m1.ply", 78);
  fs::last_write_time(folder / "m1.ply", time);
  EXPECT_EQ(fill(), 1);
  fs::rename(folder / "m0.ply", folder / "m9.ply");
  EXPECT_EQ(fill(), 1);
}

TEST_F(Cache, NeverTrustsADamagedFile) {
  fill();
  const std::string good = contents(file(0));
  std::vector<std::string> bad{"",
                               "x",
                               good.substr(0, good.size() - 1),
                               good + "x",
                               good.substr(0, 40),
                               std::string(good.size(), '\0'),
                               contents(file(1))};
  test::Random random(5);
  for (int i = 0; i < 20; ++i) {
    bad.push_back(good);
    bad.back()[std::size_t(random.below(int(good.size())))] ^= char(1 << random.below(8));
  }
  for (const std::string& bytes : bad) {
    std::ofstream(file(0), std::ios::binary) << bytes;
    EXPECT_EQ(fill(), 1);
    EXPECT_EQ(contents(file(0)), good) << "mended";
  }
}

TEST_F(Cache, ChecksWhatAForgedFileHolds) {
  fill();
  const search::ModelRaster& good = *cache_->raster(0);
  const search::RasterKey key{1, 2, 3, 4, 2};
  ASSERT_TRUE(search::decode_raster(search::encode_raster(good, key), key));
  const auto refused = [&](const auto& change) {
    search::ModelRaster r = good;
    change(r);
    return !search::decode_raster(search::encode_raster(r, key), key);
  };
  EXPECT_TRUE(refused([](search::ModelRaster& r) { r.size = 0; }));
  EXPECT_TRUE(refused([](search::ModelRaster& r) { r.origin.x() = NAN; }));
  EXPECT_TRUE(refused([](search::ModelRaster& r) { r.samples.clear(); }));
  EXPECT_TRUE(refused([](search::ModelRaster& r) { r.samples[5].at.y() = INFINITY; }));
  EXPECT_TRUE(refused([](search::ModelRaster& r) { r.levels[1].nearest[7] = std::uint16_t(r.samples.size()); }));
  EXPECT_TRUE(refused([](search::ModelRaster& r) { r.levels[0].nearest[7] = search::RasterLevel::kFar; }));
  EXPECT_TRUE(refused([](search::ModelRaster& r) { r.levels[1].dims[2] += 1; }));
  EXPECT_TRUE(refused([](search::ModelRaster& r) { r.levels[1].dims = {-1, -1, 1}; }));
  EXPECT_TRUE(refused([](search::ModelRaster& r) { r.levels[1].dims = {1000000, 1000000, 1000000}; }));
  EXPECT_TRUE(refused([](search::ModelRaster& r) { r.levels.pop_back(); }));
}

TEST_F(Cache, ASmallFileComesBack) {
  search::ModelRaster r;
  r.area = 1;
  r.samples.resize(3);
  r.levels.resize(2);
  for (search::RasterLevel& l : r.levels) l.dims = {1, 2, 1}, l.nearest = {0, 2};
  const search::RasterKey key{1, 2, 3, 4, 2};
  const std::string bytes = search::encode_raster(r, key);
  const auto back = search::decode_raster(bytes, key);
  ASSERT_TRUE(back);
  EXPECT_TRUE(same(*back, r));
  const std::string body = bytes.substr(8 + sizeof key + 16);
  EXPECT_TRUE(search::decode_raster_body(body, 2));
  for (std::size_t n = 0; n < body.size(); ++n) EXPECT_FALSE(search::decode_raster_body(body.substr(0, n), 2));
  std::string many = body;  // a count of samples that would need terabytes
  many.replace(40, 8, std::string("\xff\xfe\0\0\0\0\0\0", 8));
  EXPECT_FALSE(search::decode_raster_body(many, 2));
  test::keep_for_corpus("cache", bytes);
  test::keep_for_corpus("cache", body);
}

TEST_F(Cache, AFolderThatCannotBeWrittenCostsOnlyTime) {
  std::ofstream(folder / ".model-cache") << "a file in its place";  // root may write anywhere
  EXPECT_EQ(fill(), 3);
  EXPECT_EQ(fill(), 3);
  EXPECT_EQ(std::count_if(log_.begin(), log_.end(), [](const std::string& l) { return l.rfind("cache: ", 0) == 0; }),
            2);
  EXPECT_EQ(contents(folder / ".model-cache"), "a file in its place");
}

TEST_F(Cache, WhatIsNoLongerUsedGoes) {
  fill();
  const auto now = fs::file_time_type::clock::now();
  fs::remove(folder / "m0.ply");
  EXPECT_EQ(fill(), 0);
  EXPECT_EQ(file_count(), 3) << "a run that makes nothing takes nothing away";
  const fs::path cache = folder / ".model-cache";
  const std::string other = "moved.ply.0123456789abcdef", mine = "notes.txt", draft = ".parts-0123456789abcdef.draft";
  for (const std::string& name : {other, mine, draft}) {
    std::ofstream(cache / name) << "x";
    fs::last_write_time(cache / name, now - std::chrono::hours(24 * 40));
  }
  put("m3.ply", 3);
  fs::last_write_time(file(2), now - std::chrono::hours(24 * 40));
  EXPECT_EQ(fill(), 1);
  EXPECT_EQ(file_count(), 4) << "m1, m2, m3 and the user's notes";
  EXPECT_TRUE(fs::exists(cache / mine));
  EXPECT_FALSE(fs::exists(cache / other));
  EXPECT_FALSE(fs::exists(cache / draft));
  for (const auto& entry : fs::directory_iterator(cache))
    if (entry.path().filename() != mine) {
      EXPECT_LT(now - entry.last_write_time(), std::chrono::hours(1)) << "used today";
    }
}

TEST_F(Cache, OnlyRegularFilesAreOpened) {
  fill();
  fs::remove(file(0));
  ASSERT_EQ(::mkfifo((folder / "pipe.ply").c_str(), 0600), 0);
  EXPECT_EQ(fill(), 1) << "the pipe is skipped";
  EXPECT_EQ(std::count_if(log_.begin(), log_.end(),
                          [](const std::string& l) { return l.rfind("skipped: pipe.ply", 0) == 0; }),
            1);
  const fs::path entry = file(0);
  fs::remove(entry);
  ASSERT_EQ(::mkfifo(entry.c_str(), 0600), 0);
  EXPECT_EQ(fill(), 1);
}

TEST_F(Cache, CanBeTurnedOff) {
  EXPECT_EQ(fill(2, false), 3);
  EXPECT_FALSE(fs::exists(folder / ".model-cache"));
}

TEST_F(Cache, RunsAtTheSameTimeDoNoHarm) {
  std::vector<pid_t> children;
  for (int i = 0; i < 3; ++i) {
    const pid_t child = fork();
    if (child == 0) _exit(fills_undisturbed() ? 0 : 1);
    ASSERT_GT(child, 0);
    children.push_back(child);
  }
  for (pid_t child : children) {
    int status = 1;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  fill();
  EXPECT_EQ(fill(), 0);
  EXPECT_EQ(file_count(), 3) << "no drafts are left";
}

TEST_F(Cache, KeepsOnlyCoarseLevelsOfManyModels) {
  fill(3, true, 2);
  EXPECT_EQ(cache_->raster(1)->levels.size(), 2u);
  cache_->complete(1);
  const io::ModelDatabase& database = *database_;
  EXPECT_TRUE(same(*cache_->raster(1), search::rasterize_model(database.load(1), 3)));
  fs::remove_all(folder / ".model-cache");
  cache_->complete(2);
  EXPECT_TRUE(same(*cache_->raster(2), search::rasterize_model(database.load(2), 3)));
}

}  // namespace
}  // namespace parts
