// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/sheets.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "parts/mesh/edges.h"

namespace parts::mend {
namespace {

/// How far each sheet is from flat: the angles at its inner edges, times their lengths.
std::vector<double> bends(const Mesh& mesh, const std::vector<int>& sheet_of, std::size_t sheets) {
  std::vector<double> bend(sheets, 0);
  mesh::for_each_mesh_edge(mesh::sorted_half_edges(mesh), [&](auto first, auto last) {
    if (last - first != 2 || sheet_of[first->face] < 0 || sheet_of[first->face] != sheet_of[first[1].face]) return;
    const double cosine = mesh.normal(first->face).dot(mesh.normal(first[1].face));
    const double length = (mesh.vertices[first->from] - mesh.vertices[first->to]).norm();
    bend[sheet_of[first->face]] += length * std::acos(std::clamp(cosine, -1.0, 1.0));
  });
  return bend;
}

/// How deep a sheet lies, seen the way that it faces: the deepest point of it in each cell of a grid across.
class DepthOfSheet {
 public:
  DepthOfSheet(const Mesh& mesh, const std::vector<int>& faces) {
    Vec3 normal = Vec3::Zero();
    for (int f : faces) normal += mesh.area_vector(f);
    z_ = normal.normalized(), x_ = z_.unitOrthogonal(), y_ = z_.cross(x_);
    Eigen::AlignedBox2d box;
    for (int f : faces)
      for (int v : mesh.faces[f]) box.extend(across(mesh.vertices[v]));
    low_ = box.min();
    constexpr int kCells = 24;
    cell_ = std::max(box.sizes().maxCoeff() / kCells, 1e-300);
    for (int f : faces) {
      Eigen::AlignedBox2d b;
      double deepest = 1e300;
      for (int v : mesh.faces[f])
        b.extend(across(mesh.vertices[v])), deepest = std::min(deepest, depth(mesh.vertices[v]));
      const std::array<int, 2> from = cell(b.min()), to = cell(b.max());
      for (int i = from[0]; i <= to[0]; ++i)
        for (int j = from[1]; j <= to[1]; ++j) {
          const auto [at, fresh] = deepest_.try_emplace({i, j}, deepest);
          if (!fresh) at->second = std::min(at->second, deepest);
        }
    }
  }
  /// Whether most of the faces lie behind it, by more than a slope makes within a cell.
  bool hides(const Mesh& mesh, const std::vector<int>& faces) const {
    long behind = 0;
    for (int f : faces) {
      const Vec3 p = mesh.center(f);
      const auto at = deepest_.find(cell(across(p)));
      behind += at != deepest_.end() && depth(p) < at->second - 2 * cell_;
    }
    return 2 * behind > long(faces.size());
  }

 private:
  Eigen::Vector2d across(const Vec3& p) const { return {p.dot(x_), p.dot(y_)}; }
  double depth(const Vec3& p) const { return p.dot(z_); }
  std::array<int, 2> cell(const Eigen::Vector2d& p) const {
    return {int(std::floor((p[0] - low_[0]) / cell_)), int(std::floor((p[1] - low_[1]) / cell_))};
  }

  Vec3 x_, y_, z_;
  Eigen::Vector2d low_;
  double cell_ = 1;
  std::map<std::array<int, 2>, double> deepest_;
};

}  // namespace

Sheets::Sheets(const Scan& scan, const std::vector<std::vector<int>>& sheets)
    : scan_(scan),
      sheets_(sheets),
      area_(sheets.size(), 0),
      selected_(scan.mesh().vertices.size(), 0),
      sheet_of_(scan.mesh().faces.size(), -1) {
  const Mesh& mesh = scan.mesh();
  for (std::size_t s = 0; s < sheets.size(); ++s)
    for (int f : sheets[s]) {
      sheet_of_[f] = int(s);
      ++selected_[scan.component()[mesh.faces[f][0]]];
      area_[s] += mesh.area(f);
    }
  bend_ = bends(mesh, sheet_of_, sheets.size());
}

std::vector<char> Sheets::not_meant(const std::vector<int>& group) const {
  std::vector<char> out(group.size(), 0);
  if (group.size() < 2) return out;
  const Mesh& mesh = scan_.mesh();
  const auto component = [&](int sheet) { return scan_.component()[mesh.faces[sheets_[sheet][0]][0]]; };
  const int flaw = flaw_of(group);
  const DepthOfSheet front(mesh, sheets_[flaw]);
  for (std::size_t i = 0; i < group.size(); ++i) {
    const int s = group[i];
    if (s == flaw) continue;
    const bool partly = selected_[component(s)] < scan_.component_faces()[mesh.faces[sheets_[s][0]][0]];
    out[i] = (component(s) != component(flaw) && partly) || front.hides(mesh, sheets_[s]);
  }
  return out;
}

namespace {

Vec3 center_of(const Mesh& mesh, const std::vector<int>& faces) {
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (int f : faces) sum += mesh.area(f) * mesh.center(f), area += mesh.area(f);
  return sum / std::max(area, 1e-300);
}

/// Cells of a grid across a direction.
class Outline {
 public:
  using Cells = std::set<std::array<int, 2>>;
  Outline(const Vec3& along, const Vec3& center, double cell)
      : x_(along.unitOrthogonal()), y_(along.cross(x_)), center_(center), cell_(cell) {}
  std::array<int, 2> operator()(const Vec3& p) const {
    return {int(std::floor((p - center_).dot(x_) / cell_)), int(std::floor((p - center_).dot(y_) / cell_))};
  }
  Cells of(const Mesh& mesh, const std::vector<int>& faces) const {
    Cells cells;
    for (int f : faces) {
      cells.insert((*this)(mesh.center(f)));
      for (int v : mesh.faces[f]) cells.insert((*this)(mesh.vertices[v]));
    }
    return cells;
  }

 private:
  Vec3 x_, y_, center_;
  double cell_;
};

}  // namespace

bool Sheets::is_far_side(int sheet, int of) const {
  constexpr double kSmoother = 0.6, kSameOutline = 0.5, kAllSelected = 0.95;
  if (!(bend_[sheet] * area_[of] < kSmoother * bend_[of] * area_[sheet])) return false;
  const Mesh& mesh = scan_.mesh();
  const Vec3 near = center_of(mesh, sheets_[of]), far = center_of(mesh, sheets_[sheet]);
  Vec3 normal = Vec3::Zero();
  for (int f : sheets_[of]) normal += mesh.area_vector(f);
  const Vec3 along = (near - far).normalized();
  if (!(along.dot(normal.normalized()) > 0.5)) return false;
  const Outline outline(along, near, std::sqrt(area_[of]) / 8);
  const Outline::Cells a = outline.of(mesh, sheets_[of]), b = outline.of(mesh, sheets_[sheet]);
  Outline::Cells both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::inserter(both, both.end()));
  if (double(both.size()) < kSameOutline * double(a.size() + b.size() - both.size())) return false;
  // Inner cells only: those at the outline are selected in part.
  long inside = 0, selected = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const auto [i, j] = outline(mesh.center(f));
    bool inner = true;
    for (int di = -1; di <= 1; ++di)
      for (int dj = -1; dj <= 1; ++dj) inner = inner && both.count({i + di, j + dj}) > 0;
    if (inner) ++inside, selected += sheet_of_[f] >= 0;
  }
  return inside > 0 && double(selected) >= kAllSelected * double(inside);
}

}  // namespace parts::mend
