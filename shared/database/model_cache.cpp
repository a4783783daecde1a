// SPDX-License-Identifier: GPL-3.0-or-later
#include "database/model_cache.h"

#include <atomic>

#include "align/tasks.h"
#include "geometry/error.h"
#include "geometry/parallel.h"

namespace parts {

void ModelCache::fill(const Options& options, Progress& progress) {
  const int n = database_.size();
  rasters_.clear();
  rasters_.resize(std::size_t(n));
  std::vector<std::string> skipped(static_cast<std::size_t>(n));
  std::atomic<int> made{0};
  run_tasks(n, thread_count(options.threads), progress, [&](int i, const std::function<void()>&) {
    try {
      rasters_[i] = std::make_unique<ModelRaster>(rasterize_model(database_.load(i), options.levels));
      ++made;
    } catch (const UserError& e) {
      skipped[i] = e.what();
    }
  });
  made_ = made;
  for (int i = 0; i < n; ++i)
    if (!rasters_[i]) progress.log("skipped: " + database_.name(i) + " (" + skipped[i] + ")");
}

}  // namespace parts
