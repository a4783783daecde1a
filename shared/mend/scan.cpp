// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/scan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "parts/mesh/attributes.h"
#include "parts/mesh/pinches.h"
#include "parts/mesh/slits.h"

namespace parts::mend {
namespace {

/// Without crumbs: small pieces, hardly more than a rim, that hung on the rest
/// in vertices only.
/// @param first   vertices from here on are copies
/// @param crumbs  how many faces they had
Mesh without_crumbs(const Mesh& mesh, const std::vector<int>& copies, int first, int& crumbs) {
  constexpr int kMostFaces = 12;
  const std::vector<int> component = mesh::vertex_components(mesh);
  std::vector<int> faces(mesh.vertices.size(), 0);
  for (const Triangle& f : mesh.faces) ++faces[component[f[0]]];
  std::vector<char> hung(mesh.vertices.size(), 0), keep;
  for (std::size_t i = 0; i < copies.size(); ++i)
    for (int v : {copies[i], first + int(i)}) hung[component[v]] = 1;
  const int largest = *std::max_element(faces.begin(), faces.end());
  for (const Triangle& f : mesh.faces) {
    const int piece = component[f[0]];
    keep.push_back(!hung[piece] || faces[piece] > kMostFaces || faces[piece] == largest);
  }
  crumbs = int(std::count(keep.begin(), keep.end(), 0));
  return mesh::take_faces(mesh, keep);
}

Mesh made_ready(const Mesh& input, int& crumbs) {
  Mesh mesh = mesh::prepare_without_slits(input);
  const int first = mesh.vertex_count();
  const std::vector<int> copies = mesh::split_pinches(mesh, std::vector<char>(mesh.vertices.size(), 1));
  return copies.empty() ? mesh : without_crumbs(mesh, copies, first, crumbs);
}

/// A vertex at a place where borders meet, and the fan of faces around it.
struct Fan {
  int vertex;
  Vec3 normal = Vec3::Zero(), middle = Vec3::Zero();  ///< area-weighted; the middle as seen from the vertex
};

/// The places where several border vertices lie.
std::vector<std::vector<Fan>> meetings(const Mesh& mesh, const std::vector<mesh::Loop>& borders) {
  std::map<std::array<double, 3>, std::vector<Fan>> at;
  for (const mesh::Loop& border : borders)
    for (int v : border) at[{mesh.vertices[v].x(), mesh.vertices[v].y(), mesh.vertices[v].z()}].push_back({v});
  std::vector<std::vector<Fan>> several;
  std::vector<Fan*> fan(mesh.vertices.size(), nullptr);
  for (auto& [place, fans] : at)
    if (fans.size() > 1) several.push_back(std::move(fans));
  if (several.empty()) return several;
  for (std::vector<Fan>& fans : several)
    for (Fan& f : fans) fan[f.vertex] = &f;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f])
      if (fan[v]) fan[v]->normal += mesh.area_vector(f), fan[v]->middle += mesh.center(f) - mesh.vertices[v];
  return several;
}

/// Sorts fans around their place, counter-clockwise as seen from outside.
/// @return false: they face different ways, and are no one surface
bool sort_around(std::vector<Fan>& fans) {
  Vec3 normal = Vec3::Zero();
  for (const Fan& f : fans) normal += f.normal.normalized();
  for (const Fan& f : fans)
    if (!(f.normal.dot(normal) > 0)) return false;
  const Vec3 z = normal.normalized(), x = z.unitOrthogonal(), y = z.cross(x);
  const auto angle = [&](const Fan& f) { return std::atan2(f.middle.dot(y), f.middle.dot(x)); };
  std::sort(fans.begin(), fans.end(), [&](const Fan& a, const Fan& b) {
    return angle(a) != angle(b) ? angle(a) < angle(b) : a.vertex < b.vertex;
  });
  return true;
}

bool any_vertex_twice(const Mesh& mesh, const std::vector<mesh::Loop>& borders) {
  std::vector<char> seen(mesh.vertices.size(), 0);
  for (const mesh::Loop& border : borders)
    for (int v : border)
      if (seen[v]++) return true;
  return false;
}

/// The borders along the holes where they meet, instead of along the fans.
std::vector<mesh::Loop> along_holes(const Mesh& mesh, std::vector<mesh::Loop> borders) {
  if (any_vertex_twice(mesh, borders)) return borders;
  std::map<int, int> onto;  // where a border that comes to a vertex goes on
  for (std::vector<Fan>& fans : meetings(mesh, borders))
    if (sort_around(fans))
      for (std::size_t i = 0; i < fans.size(); ++i) onto[fans[i].vertex] = fans[(i + 1) % fans.size()].vertex;
  if (onto.empty()) return borders;
  std::map<int, int> next;
  for (const mesh::Loop& border : borders)
    for (int i = 0; i < border.size(); ++i) next[border.vertices[i]] = border.next(i);
  std::vector<mesh::Loop> rims;
  std::vector<char> left(mesh.vertices.size(), 0);
  for (const mesh::Loop& border : borders)
    for (int start : border) {
      if (left[start]) continue;
      mesh::Loop rim;
      for (int v = start; !left[v];) {
        left[v] = 1;
        rim.vertices.push_back(v);
        v = next.at(v);
        if (const auto step = onto.find(v); step != onto.end()) {
          if (step->second != v) rim.vertices.push_back(v);
          v = step->second;
        }
      }
      rims.push_back(std::move(rim));
    }
  return rims;
}

}  // namespace

std::vector<mesh::Loop> find_rims(const Mesh& mesh, int* chains) {
  std::vector<mesh::Loop> rims = mesh::boundary_loops(mesh, mesh::edge_map(mesh));
  const auto chain = [](const mesh::Loop& l) { return !l.closed; };
  const auto ring = std::stable_partition(rims.begin(), rims.end(), [&](const mesh::Loop& l) { return !chain(l); });
  if (chains) *chains = int(rims.end() - ring);
  rims.erase(ring, rims.end());
  rims = along_holes(mesh, std::move(rims));
  rims.erase(std::remove_if(rims.begin(), rims.end(), [](const mesh::Loop& l) { return l.size() < 3; }), rims.end());
  return rims;
}

Scan::Scan(const Mesh& input) : mesh_(made_ready(input, crumbs_)), origin_(mesh_.faces.size()) {
  std::iota(origin_.begin(), origin_.end(), 0);
  survey();
}

Scan::Scan(Mesh mesh, std::vector<int> origin) : mesh_(std::move(mesh)), origin_(std::move(origin)) { survey(); }

void Scan::survey() {
  rims_ = find_rims(mesh_, &chains_);
  component_ = mesh::vertex_components(mesh_);
  std::vector<int> faces(mesh_.vertices.size(), 0);
  for (const Triangle& f : mesh_.faces) ++faces[component_[f[0]]];
  for (int c : component_) component_faces_.push_back(faces[c]);
}

}  // namespace parts::mend
