// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/io/model_database.h"
#include "parts/mend/restore.h"
#include "parts/search/search.h"

namespace parts::mend {

/// What is to be found or mended, and how.
struct MendOptions {
  bool fill = false;  ///< holes; else flaws
  RegionOptions region;
  search::SearchOptions search;
  RestoreOptions restore;
};

/// A model that the search found, in the scan's place and size.
struct Found {
  int region = 0;
  Mesh mesh;
  std::string name;
  double score = 0;
};

/// The models most like the scan around its flaws and holes, best first, for
/// each region in turn. Regions around flaws where the selection holds no hole.
/// @throws UserError, Cancelled
std::vector<Found> find_models(const Mesh& scan, const io::ModelDatabase& database, const MendOptions& options,
                               Progress& progress);

struct Mended {
  Mesh mesh;
  int regions = 0, mended = 0;
  std::vector<Found> candidates;  ///< as pasted, one for each region that was mended
};

/// Restores every flaw or fills every hole of a scan, each from its own best
/// match. Of several, those that no model fits are left as they are and logged.
/// @throws UserError  none could be mended; @throws Cancelled
Mended mend_scan(const Mesh& scan, const io::ModelDatabase& database, const MendOptions& options, Progress& progress);

/// A mesh moved by a similarity, its normals turned.
Mesh placed(Mesh mesh, const Eigen::Affine3d& placement);

}  // namespace parts::mend
