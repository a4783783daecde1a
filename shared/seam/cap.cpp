// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/cap.h"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "parts/mesh/attributes.h"
#include "parts/mesh/ears.h"

namespace parts::seam {
namespace {

/// The edges and faces between vertices of contours, by place.
class Known {
 public:
  Known(const Mesh& mesh, const std::vector<mesh::Loop>& loops) {
    std::map<std::array<double, 3>, int> at;
    for (const mesh::Loop& l : loops)
      for (int v : l.vertices) {
        const Vec3& p = mesh.vertices[v];
        place_[v] = at.try_emplace({p.x(), p.y(), p.z()}, v).first->second;
      }
    std::vector<char> asked(mesh.vertices.size(), 0);
    for (const auto& [v, place] : place_) asked[v] = 1;
    for (const Triangle& f : mesh.faces)
      if (asked[f[0]] + asked[f[1]] + asked[f[2]] >= 2) add(f);
  }
  int place(int v) const {
    const auto p = place_.find(v);
    return p == place_.end() ? v : p->second;
  }
  bool joins(int u, int v) const { return place(u) == place(v) || edges_.count(edge(u, v)) > 0; }
  bool has(const Triangle& f) const { return faces_.count(face(f)) > 0; }
  void add(const Triangle& f) {
    for (int k = 0; k < 3; ++k) edges_.insert(edge(f[k], f[(k + 1) % 3]));
    faces_.insert(face(f));
  }

 private:
  std::array<int, 2> edge(int u, int v) const { return {std::min(place(u), place(v)), std::max(place(u), place(v))}; }
  Triangle face(const Triangle& f) const {
    Triangle t{place(f[0]), place(f[1]), place(f[2])};
    std::sort(t.begin(), t.end());
    return t;
  }
  std::unordered_map<int, int> place_;
  std::set<std::array<int, 2>> edges_;
  std::set<Triangle> faces_;
};

/// A contour parted where it comes to a vertex twice.
std::vector<std::vector<int>> simple_rings(const std::vector<int>& loop) {
  std::vector<std::vector<int>> rings;
  std::vector<int> path;
  std::unordered_map<int, int> at;  // vertex -> its position in the path
  for (int v : loop) {
    if (const auto seen = at.find(v); seen != at.end()) {
      rings.emplace_back(path.begin() + seen->second, path.end());
      for (int u : rings.back()) at.erase(u);
      path.resize(path.size() - rings.back().size());
    }
    at[v] = int(path.size());
    path.push_back(v);
  }
  rings.push_back(path);
  return rings;
}

void add_face(Mesh& mesh, Known& known, int like, const Triangle& f) {
  mesh::add_face_like(mesh, like, f);
  known.add(f);
}

/// A fan around a new vertex in the ring's midst.
void fan(Mesh& mesh, Known& known, const std::vector<int>& ring, const std::vector<int>& like) {
  const int n = int(ring.size()), middle = mesh::add_vertex_between(mesh, ring[0], ring[n / 2], 0.5);
  Vec3 sum = Vec3::Zero();
  for (int v : ring) sum += mesh.vertices[v];
  mesh.vertices[middle] = sum / n;
  for (int i = 0; i < n; ++i) add_face(mesh, known, like[ring[i]], {ring[(i + 1) % n], ring[i], middle});
}

void cap_ring(Mesh& mesh, Known& known, const std::vector<int>& ring, const std::vector<int>& like) {
  const int n = int(ring.size());
  if (n < 3) return;
  std::vector<Vec3> corners;
  for (int v : ring) corners.push_back(mesh.vertices[v]);
  std::vector<Triangle> ears = mesh::cut_ears(corners, [&](int i, int j) { return !known.joins(ring[i], ring[j]); });
  const bool twice = n == 3 && known.has({ring[0], ring[1], ring[2]});
  if (ears.empty() || twice) return fan(mesh, known, ring, like);
  for (const Triangle& t : ears) add_face(mesh, known, like[ring[t[1]]], {ring[t[2]], ring[t[1]], ring[t[0]]});
}

}  // namespace

void cap(Mesh& mesh, const std::vector<mesh::Loop>& loops, const std::vector<int>& like) {
  if (loops.empty()) return;
  Known known(mesh, loops);
  for (const mesh::Loop& loop : loops)
    for (const std::vector<int>& ring : simple_rings(loop.vertices)) cap_ring(mesh, known, ring, like);
}

void cap(Mesh& mesh, const mesh::Loop& loop, const std::vector<int>& like) {
  cap(mesh, std::vector<mesh::Loop>{loop}, like);
}

}  // namespace parts::seam
