// SPDX-License-Identifier: GPL-3.0-or-later
#include "mincut/isolated.h"

#include <flann/flann.hpp>

namespace parts {

void label_isolated(const JointVoxels& voxels, const std::vector<int>& group, int groups,
                    std::vector<std::int8_t>& label) {
  if (groups == 0) return;
  std::vector<float> decided, asked;
  std::vector<int> decided_node, first(groups, -1);
  const auto put = [&](std::vector<float>& to, int node) {
    for (int x : voxels.grid.cell(voxels.cells[node])) to.push_back(float(x));
  };
  for (int n = 0; n < int(voxels.size()); ++n)
    if (group[n] < 0)
      put(decided, n), decided_node.push_back(n);
    else if (first[group[n]] < 0)
      first[group[n]] = n, put(asked, n);
  if (decided_node.empty()) return;

  flann::Matrix<float> rows(decided.data(), decided_node.size(), 3);
  flann::Index<flann::L2_Simple<float>> index(rows, flann::KDTreeSingleIndexParams());
  index.buildIndex();
  // The first node of each group asks; groups are numbered by their first node.
  std::vector<int> nearest(groups);
  std::vector<float> distance(groups);
  flann::Matrix<float> queries(asked.data(), groups, 3), distances(distance.data(), groups, 1);
  flann::Matrix<int> found(nearest.data(), groups, 1);
  index.knnSearch(queries, found, distances, 1, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
  for (std::size_t n = 0; n < group.size(); ++n)
    if (group[n] >= 0) {
      const std::int8_t l = label[decided_node[nearest[group[n]]]];
      label[n] = l == VoxelLabels::kSeam ? std::int8_t(VoxelLabels::kA) : l;
    }
}

}  // namespace parts
