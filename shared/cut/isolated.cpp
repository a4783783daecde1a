// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/isolated.h"

#include <flann/flann.hpp>
#include <limits>

namespace parts::cut {

void label_isolated(const JointVoxels& voxels, const std::vector<int>& group, int groups,
                    std::vector<std::int8_t>& label) {
  if (groups == 0) return;
  std::vector<float> decided, asked;
  std::vector<int> decided_node, group_asked;
  const auto put = [&](std::vector<float>& to, int node) {
    for (int x : voxels.grid.cell(voxels.cells[node])) to.push_back(float(x));
  };
  for (int n = 0; n < int(voxels.size()); ++n)
    if (group[n] >= 0)
      put(asked, n), group_asked.push_back(group[n]);
    else
      put(decided, n), decided_node.push_back(n);
  if (decided_node.empty()) return;

  flann::Matrix<float> rows(decided.data(), decided_node.size(), 3);
  flann::Index<flann::L2_Simple<float>> index(rows, flann::KDTreeSingleIndexParams());
  index.buildIndex();
  std::vector<int> nearest(group_asked.size());
  std::vector<float> distance(group_asked.size());
  flann::Matrix<float> queries(asked.data(), asked.size() / 3, 3), distances(distance.data(), distance.size(), 1);
  flann::Matrix<int> found(nearest.data(), nearest.size(), 1);
  index.knnSearch(queries, found, distances, 1, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
  // The voxel of a group that is closest to a decided one speaks for all.
  std::vector<float> least(groups, std::numeric_limits<float>::max());
  std::vector<std::int8_t> of_group(groups, VoxelLabels::kA);
  for (std::size_t i = 0; i < nearest.size(); ++i)
    if (const int g = group_asked[i]; distance[i] < least[g])
      least[g] = distance[i], of_group[g] = label[decided_node[nearest[i]]];
  for (std::size_t n = 0; n < group.size(); ++n)
    if (group[n] >= 0) label[n] = of_group[group[n]];
}

}  // namespace parts::cut
