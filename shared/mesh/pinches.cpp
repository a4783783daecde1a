// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/pinches.h"

#include <algorithm>
#include <array>
#include <iterator>
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

namespace {

using Star = std::vector<int>;

/// The other vertices of the faces around one.
std::vector<int> link_of(const Mesh& mesh, const Star& star, int v) {
  std::vector<int> link;
  for (int f : star)
    for (int u : mesh.faces[f])
      if (u != v) link.push_back(u);
  std::sort(link.begin(), link.end());
  link.erase(std::unique(link.begin(), link.end()), link.end());
  return link;
}

}  // namespace

void weld_steps(Mesh& mesh, std::vector<int>& of_face) {
  std::vector<std::array<int, 2>> steps;
  for (const Triangle& f : mesh.faces)
    for (int k = 0; k < 3; ++k)
      if (const int u = f[k], v = f[(k + 1) % 3]; u != v && mesh.vertices[u] == mesh.vertices[v])
        steps.push_back({std::min(u, v), std::max(u, v)});
  if (steps.empty()) return;
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  std::unordered_map<int, Star> stars;
  for (const auto& [u, v] : steps) stars[u], stars[v];
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f])
      if (const auto at = stars.find(v); at != stars.end()) at->second.push_back(f);
  std::unordered_map<int, int> onto;
  const auto now = [&](int v) {
    while (onto.count(v)) v = onto[v];
    return v;
  };
  std::vector<char> keep(mesh.faces.size(), 1);
  for (const auto& step : steps) {
    const int u = now(step[0]), v = now(step[1]);
    if (u == v) continue;
    Star &at_u = stars[u], &at_v = stars[v], shared;
    for (int f : at_u)
      if (std::find(at_v.begin(), at_v.end(), f) != at_v.end()) shared.push_back(f);
    std::vector<int> a = link_of(mesh, at_u, u), b = link_of(mesh, at_v, v), common;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
    if (shared.empty() || common.size() != shared.size()) continue;  // the link condition
    onto[v] = u;
    for (int f : shared) {
      keep[f] = 0;
      for (auto& [w, star] : stars) star.erase(std::remove(star.begin(), star.end(), f), star.end());
    }
    for (int f : at_v) {
      for (int& w : mesh.faces[f])
        if (w == v) w = u;
      at_u.push_back(f);
    }
    at_v.clear();
  }
  std::vector<int> old_face, left;
  mesh = take_faces(mesh, keep, nullptr, &old_face);
  for (int f : old_face) left.push_back(of_face[f]);
  of_face = std::move(left);
}

}  // namespace parts::mesh
