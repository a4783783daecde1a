// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/depth/trust.h"

#include <algorithm>

#include "parts/depth/small_level.h"

namespace parts::depth {
namespace {

double mean_distance(synthesis::PatchImage query, const std::vector<synthesis::PatchImage>& examples,
                     const DepthOptions& options) {
  query.planes = {query.planes[0], cv::Mat()};
  return small_distance(query, examples, synthesis_options(options));
}

}  // namespace

double strangeness(const synthesis::PatchImage& small, const ExampleSet& set, const DepthOptions& options) {
  std::vector<synthesis::PatchImage> members;
  std::vector<int> objects;
  for (size_t k = 0; k < set.size() && members.size() < 12; ++k) {
    if (std::count(objects.begin(), objects.end(), set[k].object)) continue;
    synthesis::PatchImage e = set.gallery().small(set[k].object, set[k].view);
    e.planes.resize(2);
    members.push_back(e);
    objects.push_back(set[k].object);
  }
  if (members.size() < 3) return 1;  // nothing to compare with
  double strangest = 0;
  const int asked = std::min(6, int(members.size()));
  for (int i = 0; i < asked; ++i) {
    const size_t k = i * members.size() / asked;
    std::vector<synthesis::PatchImage> rest = members;
    rest.erase(rest.begin() + long(k));
    strangest = std::max(strangest, mean_distance(members[k], rest, options));
  }
  return strangest > 0 ? mean_distance(small, members, options) / strangest : 1;
}

}  // namespace parts::depth
