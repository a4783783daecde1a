// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/atlas.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "parts/base/error.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/prepare.h"

namespace parts::render {
namespace {

using Vec2 = Eigen::Vector2d;
using Corners = std::array<Vec2, 3>;

constexpr int kGutter = 2;         // texels around a chart
constexpr double kSteepest = 0.2;  // cosine between a face and its chart's direction
constexpr int kSmoothings = 4;     // of normals and of labels, so that noise makes no charts

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Calls visit(x, y, barycentric) for the texels whose centres lie inside a
/// triangle, or in its surroundings; centres on a side are not inside.
template <class Visit>
void each_texel(const Corners& t, double around, int size, const Visit& visit) {
  const double area = cross(t[1] - t[0], t[2] - t[0]);
  if (!std::isfinite(area) || std::abs(area) < 1e-12) return;
  const Vec2 low = t[0].cwiseMin(t[1]).cwiseMin(t[2]).array() - around - 0.5;
  const Vec2 high = t[0].cwiseMax(t[1]).cwiseMax(t[2]).array() + around - 0.5;
  const int x0 = int(std::ceil(std::max(low.x(), 0.))), x1 = int(std::floor(std::min(high.x(), size - 1.)));
  const int y0 = int(std::ceil(std::max(low.y(), 0.))), y1 = int(std::floor(std::min(high.y(), size - 1.)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const Vec2 p(x + 0.5, y + 0.5);
      visit(x, y,
            Vec3(cross(t[1] - p, t[2] - p) / area, cross(t[2] - p, t[0] - p) / area, cross(t[0] - p, t[1] - p) / area));
    }
}

constexpr double kInside = 1e-9;

/// The point of a triangle nearest to one outside, as barycentric coordinates. @return squared distance
double nearest(const Corners& t, const Vec2& p, Vec3& barycentric) {
  double best = 1e300;
  for (int k = 0; k < 3; ++k) {
    const Vec2 a = t[k], side = t[(k + 1) % 3] - a;
    const double s = std::clamp((p - a).dot(side) / std::max(side.squaredNorm(), 1e-300), 0., 1.);
    const double d = (a + s * side - p).squaredNorm();
    if (d >= best) continue;
    best = d;
    barycentric.setZero();
    barycentric[k] = 1 - s, barycentric[(k + 1) % 3] = s;
  }
  return best;
}

Corners texel_corners(const Wedges& w, int size) {
  Corners t;
  for (int k = 0; k < 3; ++k) t[k] = Vec2(w.uv[k].x(), 1 - w.uv[k].y()) * size;
  return t;
}

}  // namespace

TexelMap map_texels(const std::vector<Wedges>& wedges, int size) {
  TexelMap map;
  map.size = size;
  map.face.assign(std::size_t(size) * size, -1);
  map.barycentric.assign(map.face.size(), Eigen::Vector3f::Zero());
  for (std::size_t f = 0; f < wedges.size(); ++f) {
    if (wedges[f].texture < 0) continue;
    each_texel(texel_corners(wedges[f], size), 0, size, [&](int x, int y, const Vec3& b) {
      if (b.minCoeff() <= kInside) return;
      const std::size_t at = std::size_t(y) * size + x;
      if (map.face[at] >= 0) {
        ++map.conflicts;
        return;
      }
      map.face[at] = int(f), map.barycentric[at] = b.cast<float>();
    });
  }
  std::vector<float> distance(map.face.size(), 1.f);
  for (std::size_t at = 0; at < distance.size(); ++at)
    if (map.face[at] >= 0) distance[at] = -1;
  for (std::size_t f = 0; f < wedges.size(); ++f) {
    if (wedges[f].texture < 0) continue;
    const Corners t = texel_corners(wedges[f], size);
    each_texel(t, 1, size, [&](int x, int y, const Vec3&) {
      const std::size_t at = std::size_t(y) * size + x;
      if (distance[at] < 0) return;
      Vec3 b;
      const float d = float(nearest(t, Vec2(x + 0.5, y + 0.5), b));
      if (d >= distance[at]) return;
      distance[at] = d, map.face[at] = int(f), map.barycentric[at] = b.cast<float>();
    });
  }
  return map;
}

namespace {

/// The surface's faces with what the unfolding asks of them.
class Unfolding {
 public:
  explicit Unfolding(const Mesh& mesh) : mesh_(mesh) {
    find_neighbours();
    normal_.resize(mesh.faces.size());
    area_.resize(mesh.faces.size());
    for (int f = 0; f < mesh.face_count(); ++f) {
      const Vec3 n = mesh.area_vector(f);
      area_[f] = n.allFinite() ? n.norm() / 2 : 0;
      normal_[f] = area_[f] > 0 ? n.normalized() : Vec3::Zero();
    }
    label();
    total_ = std::accumulate(area_.begin(), area_.end(), 0.);
  }

  double area() const { return total_; }
  bool flat(int f) const { return area_[f] <= 0; }

  /// Connected faces of one direction, none on another of its chart.
  std::vector<std::vector<int>> charts(double texels_per_unit) {
    std::vector<std::vector<int>> done, open;
    std::vector<char> waiting(normal_.size(), 0);
    for (std::size_t f = 0; f < waiting.size(); ++f) waiting[f] = !flat(int(f));
    do {
      open = components(waiting);
      for (std::vector<int>& chart : open) {
        for (int f : chart) waiting[f] = 0;
        std::vector<int> kept;
        for (int f : without_overlap(chart, texels_per_unit, kept)) waiting[f] = 1;
        done.push_back(std::move(kept));
      }
    } while (!open.empty());
    return done;
  }

  /// Corners along the face's direction, world units.
  Corners project(int f) const {
    const int axis = label_[f] / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double turned = label_[f] % 2 ? -1 : 1;  // seen from outside, not mirrored
    Corners t;
    for (int k = 0; k < 3; ++k) t[k] = {turned * mesh_.corner(f, k)[u], -mesh_.corner(f, k)[v]};
    return t;
  }

 private:
  static Vec3 direction(int label) { return Vec3::Unit(label / 2) * (label % 2 ? -1 : 1); }
  template <class Visit>
  void each_neighbour(int f, const Visit& visit) const {
    for (int i = first_[f]; i < first_[f + 1]; ++i) visit(neighbours_[i].face, neighbours_[i].length);
  }

  /// Faces that share an edge's two points, whatever else does: corners of their
  /// own (as in STL files) and doubled faces do not part a surface.
  void find_neighbours() {
    Mesh welded;
    welded.vertices = mesh_.vertices;
    const std::vector<int> same = mesh::first_at_same_place(mesh_);
    for (const Triangle& f : mesh_.faces) welded.faces.push_back({same[f[0]], same[f[1]], same[f[2]]});
    const std::vector<mesh::HalfEdge> edges = mesh::sorted_half_edges(welded);
    const auto each_pair = [&](const auto& visit) {
      mesh::for_each_mesh_edge(edges, [&](auto first, auto last) {
        for (auto e = first; e + 1 < last; ++e)
          if (e->face != (e + 1)->face)
            visit(e->face, (e + 1)->face, (mesh_.vertices[e->from] - mesh_.vertices[e->to]).norm());
      });
    };
    first_.assign(mesh_.faces.size() + 1, 0);
    each_pair([&](int f, int g, double) { ++first_[f + 1], ++first_[g + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    neighbours_.resize(std::size_t(first_.back()));
    std::vector<int> next(first_.begin(), first_.end() - 1);
    each_pair([&](int f, int g, double length) {
      neighbours_[next[f]++] = {g, length};
      neighbours_[next[g]++] = {f, length};
    });
  }

  void label() {
    std::vector<Vec3> smooth(normal_.size());
    for (std::size_t f = 0; f < smooth.size(); ++f) smooth[f] = area_[f] * normal_[f];
    for (int i = 0; i < kSmoothings; ++i) {
      const std::vector<Vec3> last = smooth;
      for (std::size_t f = 0; f < smooth.size(); ++f)
        each_neighbour(int(f), [&](int g, double) { smooth[f] += last[g] / 3; });
    }
    label_.resize(normal_.size());
    for (std::size_t f = 0; f < label_.size(); ++f) {
      label_[f] = best_direction(smooth[f]);
      if (normal_[f].dot(direction(label_[f])) < kSteepest) label_[f] = best_direction(normal_[f]);
    }
    for (int i = 0; i < kSmoothings; ++i) {
      const std::vector<int> last = label_;
      for (std::size_t f = 0; f < label_.size(); ++f) label_[f] = majority(int(f), last);
    }
  }
  static int best_direction(const Vec3& n) {
    int axis = 0;
    n.cwiseAbs().maxCoeff(&axis);
    return 2 * axis + (n[axis] < 0);
  }
  int majority(int f, const std::vector<int>& labels) const {
    double votes[6] = {};
    each_neighbour(f, [&](int g, double length) { votes[labels[g]] += length; });
    int best = labels[f];
    for (int l = 0; l < 6; ++l)
      if (votes[l] > votes[best] && normal_[f].dot(direction(l)) >= kSteepest) best = l;
    return best;
  }

  std::vector<std::vector<int>> components(std::vector<char> waiting) const {
    std::vector<std::vector<int>> all;
    for (std::size_t first = 0; first < waiting.size(); ++first) {
      if (!waiting[first]) continue;
      std::vector<int> part{int(first)};
      waiting[first] = 0;
      for (std::size_t i = 0; i < part.size(); ++i)
        each_neighbour(part[i], [&](int g, double) {
          if (!waiting[g] || label_[g] != label_[first]) return;
          waiting[g] = 0;
          part.push_back(g);
        });
      all.push_back(std::move(part));
    }
    return all;
  }

  /// @return the faces that cover texels of those kept before them
  std::vector<int> without_overlap(const std::vector<int>& chart, double scale, std::vector<int>& kept) const {
    Eigen::AlignedBox2d box;
    for (int f : chart)
      for (const Vec2& p : project(f)) box.extend(p);
    const double longest = std::max(box.sizes().maxCoeff(), 1e-300);
    scale = std::min(scale, 8000 / longest);
    const int size = int(std::ceil(longest * scale)) + 1;
    std::vector<char> taken(std::size_t(size) * size, 0);
    std::vector<int> out;
    std::vector<std::size_t> mine;
    for (int f : chart) {
      Corners t = project(f);
      for (Vec2& p : t) p = (p - box.min()) * scale;
      bool free = true;
      mine.clear();
      each_texel(t, 0, size, [&](int x, int y, const Vec3& b) {
        if (b.minCoeff() <= kInside) return;
        mine.push_back(std::size_t(y) * size + x);
        free &= !taken[mine.back()];
      });
      if (free)
        for (std::size_t at : mine) taken[at] = 1;
      (free ? kept : out).push_back(f);
    }
    return out;
  }

  const Mesh& mesh_;
  struct Neighbour {
    int face;
    double length;  ///< of the edge between
  };
  std::vector<int> first_;  ///< per face, into neighbours_
  std::vector<Neighbour> neighbours_;
  std::vector<int> label_;
  std::vector<Vec3> normal_;
  std::vector<double> area_;
  double total_ = 0;
};

/// Rectangles on shelves, the highest first. @return whether they fit
bool pack(const std::vector<Vec2>& sizes, const std::vector<int>& order, double scale, int size,
          std::vector<Eigen::Vector2i>& places) {
  int x = 0, y = 0, shelf = 0;
  for (int i : order) {
    const Vec2 texels = (sizes[i] * scale).array().ceil() + 2 * kGutter + 1;
    if (texels.maxCoeff() > size) return false;
    const int w = int(texels.x()), h = int(texels.y());
    if (x + w > size) x = 0, y += shelf, shelf = 0;
    shelf = std::max(shelf, h);
    if (y + shelf > size) return false;
    places[i] = {x, y};
    x += w;
  }
  return true;
}

}  // namespace

Atlas make_atlas(const Mesh& mesh, int size) {
  Atlas atlas;
  atlas.wedges.resize(mesh.faces.size());
  Unfolding unfolding(mesh);
  if (unfolding.area() <= 0) return atlas;
  double most = size / std::sqrt(unfolding.area());
  const std::vector<std::vector<int>> charts = unfolding.charts(most * 0.8);
  atlas.charts = int(charts.size());
  std::vector<Vec2> low, sizes;
  for (const std::vector<int>& chart : charts) {
    Eigen::AlignedBox2d box;
    for (int f : chart)
      for (const Vec2& p : unfolding.project(f)) box.extend(p);
    low.push_back(box.min()), sizes.push_back(box.sizes());
  }
  std::vector<int> order(charts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return sizes[i].y() > sizes[j].y(); });
  std::vector<Eigen::Vector2i> places(charts.size()), fitting;
  double least = 0;
  for (int i = 0; i < 24; ++i) {
    const double middle = (least + most) / 2;
    if (pack(sizes, order, middle, size, places))
      least = middle, fitting = places;
    else
      most = middle;
  }
  if (fitting.empty())
    throw UserError("The surface falls into " + std::to_string(charts.size()) + " pieces, for which a texture of " +
                    std::to_string(size) + " x " + std::to_string(size) +
                    " has no room; choose a larger TextureSize or vertex colours, or weld the mesh first.");
  atlas.texels_per_unit = least;
  for (std::size_t c = 0; c < charts.size(); ++c)
    for (int f : charts[c]) {
      const Corners t = unfolding.project(f);
      atlas.wedges[f].texture = 0;
      for (int k = 0; k < 3; ++k) {
        const Vec2 p = (t[k] - low[c]) * least + fitting[c].cast<double>() + Vec2(kGutter + 0.5, kGutter + 0.5);
        atlas.wedges[f].uv[k] = Vec2(p.x() / size, 1 - p.y() / size).cast<float>();
      }
    }
  return atlas;
}

std::string texture_coordinates_flaw(const Mesh& mesh, int size) {
  if (mesh.wedges.size() != mesh.faces.size()) return "none";
  double area = 0, lost = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Wedges& w = mesh.wedges[f];
    const double a = mesh.area(f);
    if (!(a > 0) || !std::isfinite(a)) continue;
    if (w.texture > 0) return "several textures";
    if (w.texture < 0) return "not on all faces";
    for (const auto& uv : w.uv)
      if (!(uv.minCoeff() >= -1e-4f && uv.maxCoeff() <= 1 + 1e-4f)) return "beyond the texture";
    const Corners t = texel_corners(w, size);
    area += a;
    if (std::abs(cross(t[1] - t[0], t[2] - t[0])) < 1e-6) lost += a;
  }
  if (lost > 0.01 * area) return "degenerate";
  const TexelMap map = map_texels(mesh.wedges, size);
  const long covered = std::count_if(map.face.begin(), map.face.end(), [](int f) { return f >= 0; });
  return double(map.conflicts) > 0.01 * double(covered) ? "overlapping" : "";
}

}  // namespace parts::render
