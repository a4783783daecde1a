// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "database/model_database.h"
#include "database/model_raster.h"

namespace parts {

/// The rasterisations of a database's models, from the cache beside it where it
/// is good, else made and put there.
class ModelCache {
 public:
  explicit ModelCache(const ModelDatabase& database) : database_(database) {}

  struct Options {
    int levels = 3;
    bool files = true;  ///< read and write the cache beside the database
    int threads = 0;
  };
  /// Reads or makes all rasterisations. Models that cannot be used are logged,
  /// "skipped: name (why)".
  void fill(const Options& options, Progress& progress);

  /// Nothing for a model that cannot be used. @pre filled
  const ModelRaster* raster(int model) const { return rasters_[model].get(); }
  int made() const { return made_; }  ///< by the last fill, not read from the cache

 private:
  const ModelDatabase& database_;
  std::vector<std::unique_ptr<ModelRaster>> rasters_;
  int made_ = 0;
};

}  // namespace parts
