// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "parts/base/progress.h"
#include "parts/io/model_database.h"
#include "parts/mesh/mesh.h"

namespace parts::search {

/// What is looked for: a place in a scan.
struct SearchQuery {
  Mesh mesh;   ///< the whole scan, world space: what lies around the region helps to place the models
  Box region;  ///< around the flaw or the hole, with a margin of good surface; empty = the whole scan
  std::vector<float> face_weight;  ///< a face: 0 = damaged, does not count, to 1; empty = 1 everywhere
};

struct SearchOptions {
  int candidates = 1;        ///< how many models to return, at most
  int levels = 3;            ///< resolutions, each twice as fine as the one before, 1 to 3
  bool allow_scale = true;   ///< models may be scaled; else only changed from one unit of length to another
  bool any_rotation = true;  ///< models may lie any way; else up to about 30 degrees from the scan's frame
  bool cache = true;         ///< keep rasterisations beside the database
  int threads = 0;           ///< 0 = all cores; the result does not depend on it
};

struct Candidate {
  int model = -1;  ///< of the database
  /// A similarity that takes the model's world space to the scan's.
  Eigen::Affine3d placement = Eigen::Affine3d::Identity();
  /// RMS distance between scan and model around the region (both ways, damaged
  /// surface left out), as a share of the region's half diagonal. 0 is best.
  double score = 0;
};

/// A score above it is a doubtful one (measured: below it all are right, above it most are wrong).
constexpr double kDoubtful = 0.085;

class ModelCache;

/// What a search leaves for the next one in the same scan, database and options
/// (another hole): the models' rasterisations, and where each model fitted, which
/// is looked at first, and elsewhere only if that does not fit well.
struct SearchMemory {
  std::shared_ptr<ModelCache> models;
  std::map<int, Eigen::Affine3d> placements;  ///< model world to scan world
};

/// The models of the database with a surface most like the one around the
/// region, and where it is; best first, each model at most once (thesis 3.3.1).
/// Models that cannot be used are logged and left out.
/// @throws UserError  nothing left to compare: no surface with weight near the
///                    region, or no usable model
/// @throws Cancelled
std::vector<Candidate> find_similar(const SearchQuery& query, const io::ModelDatabase& database,
                                    const SearchOptions& options, Progress& progress, SearchMemory* memory = nullptr);

}  // namespace parts::search
