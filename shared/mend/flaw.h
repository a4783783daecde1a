// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/mend/region.h"

namespace parts::mend {

/// The constraints of a restoration (thesis 3.3.1, Fig. 7a), per face of the scan.
struct FlawConstraints {
  std::vector<char> keep;     ///< must survive: outside the region or nearest its sides, and not selected
  std::vector<char> flaw;     ///< must be replaced: selected; with a box nearest its centre
  std::vector<char> suspect;  ///< is not to be believed: selected; with a box all of it but what is kept
};
/// @param flaw   flaw_flags() of the region
/// @param share  ConstraintDistance: of the region's half size, (0, 1)
FlawConstraints flaw_constraints(const Mesh& scan, const Region& region, const std::vector<char>& flaw, double share);

/// Which faces of a scan give way to a fitted model: the minimal cut, on the
/// faces themselves, between what must survive and what must be replaced. It
/// runs along edges where the two surfaces are closest (the thesis' criterion,
/// 3.2.2, with edges instead of voxel sides). Where only a box is known, faces
/// that stand out of the model by much more than the rest must be replaced too.
/// @return a flag a face, 1 = replaced; what is left has no new non-manifold vertex
std::vector<char> cut_out_flaw(const Mesh& scan, const Region& region, FlawConstraints constraints, const Mesh& model);

}  // namespace parts::mend
