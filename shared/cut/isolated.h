// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/cut/labels.h"

namespace parts::cut {

/// Gives every undecided group of nodes (components that no seam touches: eyes
/// in a head, a button on a coat) the label of the nearest decided node.
/// @param group   per node: a group's number, or -1 where the label is decided
/// @param groups  number of groups
void label_isolated(const JointVoxels& voxels, const std::vector<int>& group, int groups,
                    std::vector<std::int8_t>& label);

}  // namespace parts::cut
