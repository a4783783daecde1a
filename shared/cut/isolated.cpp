// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/isolated.h"

#include <limits>

#include "parts/spatial/point_tree.h"

namespace parts::cut {

void label_isolated(const JointVoxels& voxels, const std::vector<int>& group, int groups,
                    std::vector<std::int8_t>& label) {
  if (groups == 0) return;
  using Tree = spatial::PointTree<3>;
  std::vector<Tree::Point> decided, asked;
  std::vector<int> decided_node, group_asked;
  const auto put = [&](std::vector<Tree::Point>& to, int node) {
    const std::array<int, 3> cell = voxels.grid.cell(voxels.cells[node]);
    to.push_back({float(cell[0]), float(cell[1]), float(cell[2])});
  };
  for (int n = 0; n < int(voxels.size()); ++n)
    if (group[n] >= 0)
      put(asked, n), group_asked.push_back(group[n]);
    else
      put(decided, n), decided_node.push_back(n);
  if (decided_node.empty()) return;

  const Tree tree(std::move(decided));
  // The voxel of a group that is closest to a decided one speaks for all.
  std::vector<float> least(groups, std::numeric_limits<float>::max());
  std::vector<std::int8_t> of_group(groups, VoxelLabels::kA);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const Tree::Nearest nearest = tree.nearest(asked[i]);
    if (const int g = group_asked[i]; nearest.squared < least[g])
      least[g] = nearest.squared, of_group[g] = label[decided_node[nearest.index]];
  }
  for (std::size_t n = 0; n < group.size(); ++n)
    if (group[n] >= 0) label[n] = of_group[group[n]];
}

}  // namespace parts::cut
