// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/search/query_surface.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "parts/base/error.h"
#include "parts/mesh/prepare.h"
#include "parts/mesh/topology.h"

namespace parts::search {
namespace {

constexpr int kGridPoints = 8000, kGridBorder = 40000, kGridCells = 48;
constexpr double kGridFocus = 1.5, kGridReach = 3;  // radii of the region that the grid covers beyond it

const char kNothingLeft[] =
    "No undamaged surface is left around the region to compare with the models: choose a larger region or a smaller "
    "selection.";

std::vector<char> undamaged(const SearchQuery& query) {
  std::vector<char> flags(query.mesh.faces.size(), 1);
  for (std::size_t f = 0; f < flags.size(); ++f) {
    if (!query.face_weight.empty()) flags[f] = query.face_weight[f] > 0;
    for (int v : query.mesh.faces[f]) flags[f] &= query.mesh.vertices[v].allFinite();
  }
  if (std::find(flags.begin(), flags.end(), 1) == flags.end()) throw UserError(kNothingLeft);
  return flags;
}

}  // namespace

QuerySurface::QuerySurface(const SearchQuery& query) {
  if (!query.face_weight.empty() && query.face_weight.size() != query.mesh.faces.size())
    throw std::invalid_argument("one weight a face");
  const std::vector<char> flags = undamaged(query);
  surface_ = spatial::make_surface(query.mesh, flags, "scanned");
  origin_ = surface_.origin, size_ = surface_.size;

  // The triangles again, with their weights; those without area are left out.
  surface_.triangles.clear(), surface_.normals.clear(), surface_.area_up_to.clear();
  double area = 0;
  for (std::size_t f = 0; f < flags.size(); ++f) {
    if (!flags[f]) continue;
    std::array<Vec3, 3> t;
    for (int k = 0; k < 3; ++k) t[k] = (query.mesh.corner(int(f), k) - origin_) / size_;
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const double twice = normal.norm();
    if (!(twice > 1e-14)) continue;
    surface_.triangles.push_back(t);
    surface_.normals.push_back(normal / twice);
    surface_.area_up_to.push_back(area += twice / 2);
    face_weight_.push_back(query.face_weight.empty() ? 1 : std::min(1.0, double(query.face_weight[f])));
  }

  Box all;
  for (const auto& t : surface_.triangles)
    for (const Vec3& v : t) all.extend(v);
  region_ = query.region.isEmpty()
                ? all
                : Box((query.region.min() - origin_) / size_, (query.region.max() - origin_) / size_);
  radius_ = std::max(region_.diagonal().norm() / 2, 1e-3 * all.diagonal().norm());
  double nearest = INFINITY;
  for (const auto& t : surface_.triangles)
    for (const Vec3& v : t) nearest = std::min(nearest, region_.exteriorDistance(v));
  if (!(nearest < 2 * radius_)) throw UserError(kNothingLeft);
  make_grid(query);
}

spatial::Surface QuerySurface::weighted(double reach) const {
  spatial::Surface w = surface_;
  double total = 0;
  for (std::size_t t = 0; t < w.triangles.size(); ++t) {
    const double area = surface_.area_up_to[t] - (t ? surface_.area_up_to[t - 1] : 0);
    const Vec3 center = (w.triangles[t][0] + w.triangles[t][1] + w.triangles[t][2]) / 3;
    w.area_up_to[t] = total += area * face_weight_[t] * weight(center, reach);
  }
  return w;
}

std::vector<spatial::Sample> QuerySurface::samples(double reach, int count) const {
  return spatial::sample_surface(weighted(reach), count);
}

double QuerySurface::weighted_area(double reach) const { return weighted(reach).area(); }

void QuerySurface::make_grid(const SearchQuery& query) {
  const Mesh& mesh = query.mesh;
  Eigen::AlignedBox3f box(region_.min().cast<float>(), region_.max().cast<float>());
  box.min().array() -= float(kGridReach * radius_), box.max().array() += float(kGridReach * radius_);
  const spatial::Surface near = weighted(kGridFocus);
  spacing_ = std::sqrt(near.area() / kGridPoints);
  for (const spatial::Sample& s : spatial::sample_surface(near, kGridPoints))
    points_.push_back({s.point.cast<float>(), s.normal.cast<float>()});
  known_ = points_.size();

  const auto add = [&](const Vec3& world) {
    const Eigen::Vector3f p = ((world - origin_) / size_).cast<float>();
    if (p.allFinite() && box.contains(p)) points_.push_back({p, Eigen::Vector3f::Zero()});
  };
  const mesh::EdgeMap edges = mesh::edge_map(mesh::welded(mesh));  // or scans of loose triangles would be all border
  for (int f = 0; f < mesh.face_count(); ++f) {
    const bool damaged = !query.face_weight.empty() && !(query.face_weight[f] > 0);
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = mesh.corner(f, k), &b = mesh.corner(f, (k + 1) % 3);
      if (damaged) add(a);
      if (!damaged && edges.mate[3 * f + k] != mesh::EdgeMap::kBoundary) continue;
      const int n = std::clamp(int((b - a).norm() / (0.5 * spacing_ * size_)), 1, 20);
      for (int i = 0; i < n; ++i) add(a + (i + 0.5) / n * (b - a));
    }
    if (damaged) add((mesh.corner(f, 0) + mesh.corner(f, 1) + mesh.corner(f, 2)) / 3);
  }
  if (points_.size() > known_ + kGridBorder) {  // every n-th is enough
    const std::size_t step = (points_.size() - known_) / kGridBorder + 1;
    std::size_t kept = known_;
    for (std::size_t i = known_; i < points_.size(); i += step) points_[kept++] = points_[i];
    points_.resize(kept);
  }
  grid_ = nearest_samples(points_, box, kGridCells, 12);
}

QuerySurface::Known QuerySurface::nearest(const Vec3& p, RasterPoint& found) const {
  if (region_.squaredExteriorDistance(p) > std::pow(kGridReach * radius_, 2)) return Known::Nothing;
  const std::uint16_t i = grid_.at(p);
  if (i == RasterLevel::kFar) return Known::Far;
  if (i >= known_) return Known::Nothing;
  found = points_[i];
  return Known::Surface;
}

}  // namespace parts::search
