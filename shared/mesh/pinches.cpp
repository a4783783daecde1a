// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/pinches.h"

#include <algorithm>
#include <unordered_map>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/attributes.h"

namespace parts::mesh {

std::vector<int> split_pinches(Mesh& mesh, const std::vector<char>& asked) {
  std::unordered_map<int, std::vector<int>> stars;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f])
      if (asked[v]) stars[v].push_back(f);
  std::vector<int> order, copied;
  for (const auto& star : stars) order.push_back(star.first);
  std::sort(order.begin(), order.end());
  for (int v : order) {
    const std::vector<int>& star = stars[v];
    DisjointSets fans(int(star.size()));
    std::unordered_map<int, int> first_at;  // other vertex -> the first face with that edge
    for (int i = 0; i < int(star.size()); ++i)
      for (int u : mesh.faces[star[i]])
        if (u != v)
          if (const auto [it, fresh] = first_at.try_emplace(u, i); !fresh) fans.unite(it->second, i);
    std::unordered_map<int, int> copy_of{{fans.find(0), v}};
    for (int i = 0; i < int(star.size()); ++i) {
      const auto [it, fresh] = copy_of.try_emplace(fans.find(i), mesh.vertex_count());
      if (fresh) add_vertex_between(mesh, v, v, 0), copied.push_back(v);
      for (int& u : mesh.faces[star[i]])
        if (u == v) u = it->second;
    }
  }
  return copied;
}

}  // namespace parts::mesh
