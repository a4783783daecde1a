// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parts/base/progress.h"
#include "parts/mend/scan.h"

namespace parts::mend {

/// The ways to say where a scan is to be mended.
enum class RegionBy {
  Selection,      ///< its selected faces: the flaws, or faces beside the holes
  Holes,          ///< around each of its holes
  Box,            ///< what a box holds
  SelectedOrAll,  ///< as Selection where flaws or holes are selected, else as Holes
};

struct RegionOptions {
  RegionBy by = RegionBy::Selection;
  Box box;                     ///< with Box, world units
  double margin = 0;           ///< good surface around flaw or hole, world units; 0 = 0.35 of its half diagonal
                               ///< (none around a box that the user drew)
  double longest_rim = 0;      ///< of all holes, longer ones are meant to be (a neck, a base), world units; 0 = any
  int largest_hole = 0;        ///< so are those of more edges; 0 = any
  bool leave_selected = true;  ///< with Holes: so are those at which a face is selected
};

/// A place to be mended.
struct Region {
  Box box;                       ///< flaw or hole and the margin around it
  std::vector<int> flaw;         ///< damaged faces, ascending, of the first scan; empty where only the box is known
  std::vector<mesh::Loop> rims;  ///< of the holes in it; empty for a flaw
  std::vector<int> not_meant;    ///< selected faces behind the flaw, which stay
  double size() const { return box.diagonal().norm() / 2; }
};

/// Per face of a scan that may have changed, 1 = damaged; empty where the region knows of none.
std::vector<char> flaw_flags(const Scan& scan, const Region& region);

/// Of the rims of a scan that has changed, those that still hold an edge of the
/// rims it had: a patch may join a rim in part, and numbers change.
/// @param before  the scan whose rims are given
std::vector<mesh::Loop> rims_left(const Mesh& now, const Mesh& before, const std::vector<mesh::Loop>& rims);

/// The flaws to be restored: one region for each group of selected faces, or
/// the box. With Holes, as hole_regions().
/// @throws UserError  nothing is selected, the box is none, or holds no surface
/// @throws Cancelled
std::vector<Region> flaw_regions(const Scan& scan, const RegionOptions& options, Progress& progress);

/// The holes to be filled, one region each, the longest rim first.
/// @throws UserError  there is no hole where the options say
std::vector<Region> hole_regions(const Scan& scan, const RegionOptions& options);

}  // namespace parts::mend
