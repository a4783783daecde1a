// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/seam.h"

#include <algorithm>
#include <queue>
#include <unordered_map>

#include "parts/mesh/attributes.h"
#include "parts/mesh/prepare.h"
#include "parts/seam/band.h"

namespace parts::seam {
namespace {

constexpr int kFlipRounds = 4;

Vec3 area_normal(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

/// The faces around the vertices in and next to the seam, kept up to date while
/// edges collapse and flip.
class SeamZone {
 public:
  SeamZone(Mesh& mesh, std::vector<char>& seam, const std::vector<char>& fixed)
      : mesh_(mesh), seam_(seam), fixed_(fixed), dead_(mesh.faces.size(), 0) {
    std::vector<char> zone(mesh.vertices.size(), 0);
    for (const Triangle& f : mesh.faces)
      if (seam[f[0]] || seam[f[1]] || seam[f[2]])
        for (int v : f) zone[v] = 1;
    for (int f = 0; f < mesh.face_count(); ++f)
      for (int v : mesh.faces[f])
        if (zone[v]) star_[v].push_back(f);
  }

  void collapse_short(const SeamTidying& shortest);
  void flip_badly_shaped(int rounds);
  std::vector<char> alive() const {
    std::vector<char> a(dead_.size());
    for (std::size_t f = 0; f < a.size(); ++f) a[f] = !dead_[f];
    return a;
  }

 private:
  std::vector<int> neighbours(int v) const {
    std::vector<int> n;
    for (int f : star_.at(v))
      for (int u : mesh_.faces[f])
        if (u != v) n.push_back(u);
    std::sort(n.begin(), n.end());
    n.erase(std::unique(n.begin(), n.end()), n.end());
    return n;
  }
  /// Faces that hold both vertices.
  std::vector<int> shared_faces(int u, int v) const {
    std::vector<int> s;
    for (int f : star_.at(u))
      for (int w : mesh_.faces[f])
        if (w == v) s.push_back(f);
    return s;
  }
  /// Every edge at v has two faces.
  bool interior(int v) const {
    for (int u : neighbours(v))
      if (shared_faces(v, u).size() != 2) return false;
    return true;
  }
  bool try_collapse(int gone, int stays, const Vec3& to, double most_swept);
  double swept(int v, const Vec3& to) const;
  bool moves_well(int v, const Vec3& to, int except) const;
  bool try_flip(int u, int v);

  Mesh& mesh_;
  std::vector<char>& seam_;
  const std::vector<char>& fixed_;
  std::vector<char> dead_;
  double edge_ = 1e100;  ///< the seam's mean edge
  std::unordered_map<int, std::vector<int>> star_;
};

/// Whether v's faces that do not hold `except` keep their side when v moves.
bool SeamZone::moves_well(int v, const Vec3& to, int except) const {
  for (int f : star_.at(v)) {
    const Triangle& t = mesh_.faces[f];
    if (t[0] == except || t[1] == except || t[2] == except) continue;
    std::array<Vec3, 3> p;
    for (int k = 0; k < 3; ++k) p[k] = t[k] == v ? to : mesh_.vertices[t[k]];
    const Vec3 before = mesh_.area_vector(f);
    const Vec3 after = area_normal(p[0], p[1], p[2]);
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (p[k] - p[(k + 1) % 3]).squaredNorm());
    if (after.norm() < 0.02 * longest && after.norm() < before.norm()) return false;
    // A sliver's own normal means nothing, unless it is as long as to count for something.
    if (before.norm() > 0.1 * std::min(longest, 4 * edge_ * edge_) &&
        after.dot(before) < 0.3 * after.norm() * before.norm())
      return false;
  }
  return true;
}

/// The volume between the surface as it is and with a vertex moved.
double SeamZone::swept(int v, const Vec3& to) const {
  double sum = 0;
  for (int f : star_.at(v)) sum += std::abs(mesh_.area_vector(f).dot(to - mesh_.vertices[v])) / 6;
  return sum;
}

/// @param most_swept  of volume, if one of the two was welded
bool SeamZone::try_collapse(int gone, int stays, const Vec3& to, double most_swept) {
  const std::vector<int> shared = shared_faces(gone, stays);
  if (shared.size() != 2 || !interior(gone) || !interior(stays)) return false;
  const std::vector<int> a = neighbours(gone), b = neighbours(stays);
  std::vector<int> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  if (common.size() != 2) return false;  // the link condition
  for (int c : common)
    if (!star_.count(c) || star_.at(c).size() <= 3) return false;
  if (!moves_well(gone, to, stays) || !moves_well(stays, to, gone)) return false;
  if (((seam_[gone] | seam_[stays]) & kWelded) && swept(gone, to) + swept(stays, to) > most_swept) return false;
  for (int f : shared) {
    dead_[f] = 1;
    for (int v : mesh_.faces[f]) {
      auto& s = star_.at(v);
      s.erase(std::remove(s.begin(), s.end(), f), s.end());
    }
  }
  for (int f : star_.at(gone)) {
    for (int& v : mesh_.faces[f])
      if (v == gone) v = stays;
    star_.at(stays).push_back(f);
  }
  star_.erase(gone);
  mesh_.vertices[stays] = to;
  seam_[stays] |= seam_[gone];
  return true;
}

void SeamZone::collapse_short(const SeamTidying& shortest) {
  if (shortest.edge > 0) edge_ = shortest.edge;
  using Entry = std::pair<double, std::array<int, 2>>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto offer = [&](int u, int v) {
    if (!(seam_[u] || seam_[v]) || !star_.count(u) || !star_.count(v)) return;
    const double d = (mesh_.vertices[u] - mesh_.vertices[v]).norm();
    const bool across = (seam_[u] | seam_[v]) == (kBorderA | kBorderB) && seam_[u] != seam_[v];
    const double most = across ? shortest.across : shortest.within;
    if (d < most) queue.push({d / most, {std::min(u, v), std::max(u, v)}});
  };
  for (int f = 0; f < mesh_.face_count(); ++f) {
    const Triangle t = mesh_.faces[f];
    for (int k = 0; k < 3; ++k)
      if (t[k] < t[(k + 1) % 3]) offer(t[k], t[(k + 1) % 3]);
  }
  while (!queue.empty()) {
    const std::array<int, 2> e = queue.top().second;
    queue.pop();
    int gone = e[0], stays = e[1];
    if (!star_.count(gone) || !star_.count(stays) || shared_faces(gone, stays).empty()) continue;
    // What the inputs had stays in place; of two new vertices both give way.
    if (fixed_[gone] || (!seam_[gone] && seam_[stays] && !fixed_[stays])) std::swap(gone, stays);
    const bool at_one_place = mesh_.vertices[gone] == mesh_.vertices[stays];
    if (!at_one_place && (fixed_[gone] || !seam_[gone])) continue;
    const bool both = seam_[stays] && !fixed_[stays];
    const Vec3 middle = 0.5 * (mesh_.vertices[gone] + mesh_.vertices[stays]);
    if (!try_collapse(gone, stays, both ? middle : mesh_.vertices[stays], std::pow(edge_, 3))) continue;
    for (int u : neighbours(stays)) offer(stays, u);
  }
}

bool SeamZone::try_flip(int u, int v) {
  const std::vector<int> shared = shared_faces(u, v);
  if (shared.size() != 2) return false;
  int f = shared[0], g = shared[1];
  const auto corner_of = [&](int face, int vertex) {
    for (int k = 0; k < 3; ++k)
      if (mesh_.faces[face][k] == vertex) return k;
    return -1;
  };
  if (mesh_.faces[f][(corner_of(f, u) + 1) % 3] != v) std::swap(f, g);
  if (mesh_.faces[f][(corner_of(f, u) + 1) % 3] != v || mesh_.faces[g][(corner_of(g, v) + 1) % 3] != u) return false;
  const int fu = corner_of(f, u), gv = corner_of(g, v);
  const int a = mesh_.faces[f][(fu + 2) % 3], b = mesh_.faces[g][(gv + 2) % 3];
  if (a == b || !star_.count(a) || !star_.count(b) || !shared_faces(a, b).empty()) return false;
  if (star_.at(u).size() <= 3 || star_.at(v).size() <= 3) return false;
  const Vec3 &pu = mesh_.vertices[u], &pv = mesh_.vertices[v], &pa = mesh_.vertices[a], &pb = mesh_.vertices[b];
  const auto angle = [](const Vec3& apex, const Vec3& p, const Vec3& q) {
    return std::atan2((p - apex).cross(q - apex).norm(), (p - apex).dot(q - apex));
  };
  if (angle(pa, pu, pv) + angle(pb, pu, pv) <= M_PI + 0.1) return false;  // locally Delaunay already
  const Vec3 n1 = area_normal(pu, pv, pa), n2 = area_normal(pv, pu, pb), m1 = area_normal(pa, pb, pv),
             m2 = area_normal(pb, pa, pu), n = n1 + n2;
  // A sliver has no say in where the surface faces; the new faces must agree.
  if (m1.dot(n) < 0.8 * m1.norm() * n.norm() || m2.dot(n) < 0.8 * m2.norm() * n.norm()) return false;
  if (!mesh_.wedges.empty()) {
    Wedges &wf = mesh_.wedges[f], &wg = mesh_.wedges[g];
    if (wf.texture != wg.texture) return false;
    const Eigen::Vector2f fu_uv = wf.uv[fu], fv_uv = wf.uv[(fu + 1) % 3], fa = wf.uv[(fu + 2) % 3];
    const Eigen::Vector2f gv_uv = wg.uv[gv], gu_uv = wg.uv[(gv + 1) % 3], gb = wg.uv[(gv + 2) % 3];
    if (wf.texture >= 0 && (fu_uv != gu_uv || fv_uv != gv_uv)) return false;
    wf.uv = {fa, gb, fv_uv}, wg.uv = {gb, fa, gu_uv};
  }
  mesh_.faces[f] = {a, b, v}, mesh_.faces[g] = {b, a, u};
  const auto drop = [&](int vertex, int face) {
    auto& s = star_.at(vertex);
    s.erase(std::remove(s.begin(), s.end(), face), s.end());
  };
  drop(u, f), drop(v, g);
  star_.at(b).push_back(f), star_.at(a).push_back(g);
  return true;
}

void SeamZone::flip_badly_shaped(int rounds) {
  for (int round = 0, flipped = 1; round < rounds && flipped; ++round) {
    flipped = 0;
    for (int f = 0; f < mesh_.face_count(); ++f) {
      if (dead_[f]) continue;
      for (int k = 0; k < 3; ++k) {
        const int u = mesh_.faces[f][k], v = mesh_.faces[f][(k + 1) % 3];
        // An edge between seam vertices is the seam itself, often a crease: it stays.
        if (u > v || !seam_[u] == !seam_[v] || !star_.count(u) || !star_.count(v)) continue;
        // Kept faces are the user's: none of them changes.
        bool kept = false;
        for (int s : shared_faces(u, v)) {
          const Triangle& t = mesh_.faces[s];
          kept |= fixed_[t[0]] && fixed_[t[1]] && fixed_[t[2]];
        }
        if (!kept && try_flip(u, v)) {
          ++flipped;
          break;
        }
      }
    }
  }
}

template <class T>
void compact(std::vector<T>& array, const std::vector<int>& indices) {
  std::vector<T> out;
  for (int i : indices) out.push_back(array[i]);
  array.swap(out);
}

}  // namespace

void tidy_seam(Mesh& mesh, std::vector<char>& seam, std::vector<char>& fixed, std::vector<char>& tag,
               const SeamTidying& shortest) {
  SeamZone zone(mesh, seam, fixed);
  zone.collapse_short(shortest);
  zone.flip_badly_shaped(kFlipRounds);
  std::vector<int> old_vertex, old_face;
  mesh = mesh::take_faces(mesh, zone.alive(), &old_vertex, &old_face);
  compact(seam, old_vertex), compact(fixed, old_vertex), compact(tag, old_face);
}

void flip_seam(Mesh& mesh, std::vector<char>& seam, const std::vector<char>& fixed) {
  SeamZone(mesh, seam, fixed).flip_badly_shaped(kFlipRounds);
}

void part_places(Mesh& mesh, const std::vector<char>& seam, const std::vector<char>& fixed) {
  constexpr double kStep = 0.1;  // of the way to its neighbours' mean
  const std::vector<int> first = mesh::first_at_same_place(mesh);
  std::vector<char> moves(mesh.vertices.size(), 0);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (first[v] == v) continue;
    // Of those at one place the one that comes first stays, or else the one that must.
    const int u = seam[v] && !fixed[v] ? v : first[v];
    moves[u] = seam[u] && !fixed[u];
  }
  std::vector<Vec3> sum(mesh.vertices.size(), Vec3::Zero());
  std::vector<int> count(mesh.vertices.size(), 0);
  for (const Triangle& f : mesh.faces)
    for (int v : f)
      if (moves[v])
        for (int u : f) sum[v] += mesh.vertices[u], ++count[v];
  for (std::size_t v = 0; v < moves.size(); ++v)
    if (moves[v] && count[v]) mesh.vertices[v] += kStep * (sum[v] / count[v] - mesh.vertices[v]);
}

void even_seam(Mesh& mesh, const std::vector<char>& seam, const std::vector<char>& fixed, int iterations) {
  constexpr char kOne = kBorderA | kBorderB;
  std::unordered_map<int, std::vector<int>> along;
  for (const Triangle& f : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      const int u = f[k], v = f[(k + 1) % 3];
      if (seam[u] == kOne && seam[v] == kOne) along[u].push_back(v);
    }
  std::vector<int> moving;
  for (auto& [v, next] : along) {
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    if (next.size() == 2 && !fixed[v]) moving.push_back(v);
  }
  std::sort(moving.begin(), moving.end());
  std::vector<Vec3> to(moving.size());
  for (int round = 0; round < 2 * iterations; ++round) {
    const double step = round % 2 ? -0.53 : 0.5;
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const std::vector<int>& n = along[moving[i]];
      const Vec3& x = mesh.vertices[moving[i]];
      to[i] = x + step * (0.5 * (mesh.vertices[n[0]] + mesh.vertices[n[1]]) - x);
    }
    for (std::size_t i = 0; i < moving.size(); ++i) mesh.vertices[moving[i]] = to[i];
  }
}

void smooth_seam(Mesh& mesh, const std::vector<char>& seam, const std::vector<char>& fixed, double distance,
                 int iterations, double weight) {
  if (iterations <= 0 || weight <= 0 || !(distance > 0)) return;
  const Band band = band_around(mesh, seam, distance);
  std::vector<int> moving;
  for (int v : band.vertices)
    if (!fixed[v] && !band.on_border[v]) moving.push_back(v);
  std::vector<Vec3> next(moving.size());
  for (int round = 0; round < iterations; ++round) {
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const int v = moving[i];
      // Near neighbours count more, so that uneven triangles do not drag. Of what reaches beyond the
      // distance only the near part counts, and less the longer it is: it would be moved as a whole.
      Vec3 sum = Vec3::Zero();
      double weights = 0, lengths = 0;
      for (int u : band.around[v]) {
        const Vec3 to = mesh.vertices[u] - mesh.vertices[v];
        const double length = std::max(to.norm(), 1e-300), part = std::min(1.0, 0.5 * distance / length);
        sum += part / length * to, weights += 1 / length, lengths += length;
      }
      const double reach = std::min(1.0, distance * double(band.around[v].size()) / lengths);
      next[i] = mesh.vertices[v] + weight * reach * (1 - band.away[v] / distance) / weights * sum;
    }
    for (std::size_t i = 0; i < moving.size(); ++i) mesh.vertices[moving[i]] = next[i];
  }
}

}  // namespace parts::seam
