// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

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
/// @param database  none: the scan itself, and its mirror image
/// @throws UserError, Cancelled
std::vector<Found> find_models(const Mesh& scan, const io::ModelDatabase* database, const MendOptions& options,
                               Progress& progress);

struct Ranked {
  std::string name;
  double score = 0;
};

/// What became of a region.
struct RegionReport {
  enum class End {
    Left,        ///< as it was
    Mended,      ///< from a model
    WithOthers,  ///< the patch of another hole reached it
    Small,       ///< a hole of so few edges that no detail fits into it: closed by a few faces
  };
  End end = End::Left;
  int edges = 0;                   ///< of the hole's rim; 0 for a flaw
  Vec3 center = Vec3::Zero();      ///< of the region, world units
  int not_meant = 0;               ///< selected faces behind the flaw, left as they are
  std::string left_because;        ///< with Left: a sentence
  std::vector<Ranked> candidates;  ///< of the search, best first
  RestoreReport restored;          ///< with Mended
};

struct Mended {
  Mesh mesh;                          ///< its new faces selected, no others
  std::vector<RegionReport> regions;  ///< holes: the longest rim first
  std::vector<Found> candidates;      ///< as pasted, one for each region that was mended from a model
  int chains = 0;                     ///< borders that end at edges of more than two faces, and bound no hole
  int crumbs = 0;                     ///< faces of the scan that hung on the rest in vertices only, and are gone
  int count(RegionReport::End end) const;
};

/// Restores every flaw or fills every hole of a scan, each from its own best
/// match. Of several, those that no model fits are left as they are, and
/// reported so.
/// @param database  none: the scan itself, and its mirror image
/// @throws UserError  none could be mended; @throws Cancelled
Mended mend_scan(const Mesh& scan, const io::ModelDatabase* database, const MendOptions& options, Progress& progress);

/// In words what was mended, and what is as it was and why.
std::string summary(const Mended& mended, bool fill);

}  // namespace parts::mend
