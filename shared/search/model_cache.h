// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "parts/io/model_database.h"
#include "parts/search/raster_file.h"

namespace parts::search {

/// The rasterisations of a database's models, from files beside it where they
/// are good, else made and put there (in the folder ".model-cache", one file a
/// model). A file counts only if it was made by this version of the code for a
/// model file of that size, time, content (a sample of it) and matrix, and is
/// whole: anything else is made anew. Files are replaced at once (rename), so
/// that runs at the same time do each other no harm. A run that makes files takes
/// away those of models that are gone from a folder, and those that no run has
/// used for thirty days.
class ModelCache {
 public:
  struct Options {
    int levels = 3;
    bool files = true;  ///< false: nothing is read or written
    int threads = 0;
    int kept = 100;  ///< of more models than this, only the coarse levels stay in memory
  };
  /// @param database  kept by reference
  ModelCache(const io::ModelDatabase& database, const Options& options);

  /// Reads or makes all rasterisations. Models that cannot be used are logged,
  /// "skipped: name (why)"; so is a folder that cannot be written.
  void fill(Progress& progress);

  /// Nothing for a model that cannot be used; at least its two coarsest levels. @pre filled
  const ModelRaster* raster(int model) const { return rasters_[std::size_t(model)].get(); }
  /// Brings back the finer levels. Not for two threads and one model at a time.
  void complete(int model);

  int made() const { return made_; }  ///< by fill, not read from files

 private:
  std::string file(int model) const;
  bool is_orphan(const std::filesystem::path& entry) const;
  void prune() const;
  RasterKey key(int model) const;
  std::unique_ptr<ModelRaster> read(int model) const;
  bool write(int model, const ModelRaster& raster, const RasterKey& key) const;

  const io::ModelDatabase& database_;
  Options options_;
  std::string folder_;
  std::vector<std::unique_ptr<ModelRaster>> rasters_;
  int made_ = 0;
};

}  // namespace parts::search
