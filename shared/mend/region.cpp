// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/region.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "parts/base/disjoint_sets.h"
#include "parts/base/error.h"
#include "parts/mend/sheets.h"
#include "parts/mesh/edges.h"

namespace parts::mend {
namespace {

constexpr double kMargin = 0.35;  // of the half diagonal

/// A box with a margin, and at least half as thick as it is long: flat holes have an above and a below.
Box with_margin(Box box, double margin) {
  if (!(margin > 0)) margin = kMargin * box.diagonal().norm() / 2;
  const double least = 0.5 * (box.sizes().maxCoeff() + 2 * margin);
  for (int d = 0; d < 3; ++d) {
    const double grow = std::max(margin, (least - box.sizes()[d]) / 2);
    box.min()[d] -= grow, box.max()[d] += grow;
  }
  return box;
}

Box checked_box(const Mesh& scan, const RegionOptions& o) {
  if (!o.box.min().allFinite() || !o.box.max().allFinite())
    throw UserError("The region's corners are not finite numbers; give RegionMin and RegionMax in world units.");
  if (!(o.box.sizes().minCoeff() > 0))
    throw UserError("The region has no thickness; make every coordinate of RegionMax larger than that of RegionMin.");
  Box box = o.box;
  box.min().array() -= o.margin, box.max().array() += o.margin;
  for (int f = 0; f < scan.face_count(); ++f)
    if (box.intersects(scan.face_box(f))) return box;
  throw UserError("There is no surface in the region; move the box to where the flaw or the hole is.");
}

std::vector<char> selected_faces(const Mesh& scan) {
  std::vector<char> selected = scan.face_selected;
  selected.resize(scan.faces.size(), 0);
  if (std::find(selected.begin(), selected.end(), 1) == selected.end() && !scan.vertex_selected.empty())
    for (int f = 0; f < scan.face_count(); ++f)
      for (int v : scan.faces[f]) selected[f] |= scan.vertex_selected[v];
  return selected;
}

Box box_of(const Mesh& scan, const mesh::Loop& rim) {
  Box box;
  for (int v : rim.vertices) box.extend(scan.vertices[v]);
  return box;
}

void check_scan(const Mesh& scan) {
  if (scan.faces.empty()) throw UserError("There is no face in the scan; choose a layer that holds a surface.");
}

}  // namespace

std::vector<mesh::Loop> rims_left(const Mesh& now, const Mesh& before, const std::vector<mesh::Loop>& rims) {
  const auto place = [](const Mesh& m, const mesh::Loop& l, int i) {
    return mesh::edge_place(m, l.vertices[i], l.next(i));
  };
  const auto step = [](const Mesh& m, const mesh::Loop& l, int i) {  // where holes meet, no edge
    return m.vertices[l.vertices[i]] == m.vertices[l.next(i)];
  };
  std::set<mesh::EdgePlace> edges;
  for (const mesh::Loop& rim : rims)
    for (int i = 0; i < rim.size(); ++i)
      if (!step(before, rim, i)) edges.insert(place(before, rim, i));
  std::vector<mesh::Loop> left;
  for (mesh::Loop& rim : find_rims(now)) {
    bool held = false;
    for (int i = 0; i < rim.size() && !held; ++i) held = !step(now, rim, i) && edges.count(place(now, rim, i)) > 0;
    if (held) left.push_back(std::move(rim));
  }
  return left;
}

namespace {

/// Not the outlines of crumbs: loose pieces that are hardly more than a rim.
std::vector<mesh::Loop> rims_of_surfaces(const Scan& scan) {
  const std::vector<int>& faces = scan.component_faces();
  const int largest = faces.empty() ? 0 : *std::max_element(faces.begin(), faces.end());
  std::vector<mesh::Loop> rims;
  for (const mesh::Loop& rim : scan.rims()) {
    int own = 0;
    for (int v : rim) own = std::max(own, faces[v]);
    const bool crumb = own <= rim.size() - 2 || (own <= 2 * rim.size() && own < largest);
    if (!crumb) rims.push_back(rim);
  }
  return rims;
}

/// Groups of selected faces that hang together in vertices.
struct Flecks {
  std::vector<Box> box;
  std::vector<std::vector<int>> faces;
};

Flecks flecks_of(const Mesh& scan, const std::vector<char>& selected) {
  DisjointSets sets(scan.vertex_count());
  for (int f = 0; f < scan.face_count(); ++f)
    if (selected[f]) sets.unite(scan.faces[f][0], scan.faces[f][1]), sets.unite(scan.faces[f][0], scan.faces[f][2]);
  Flecks flecks;
  std::vector<int> number(scan.vertices.size(), -1);
  for (int f = 0; f < scan.face_count(); ++f) {
    if (!selected[f]) continue;
    int& n = number[sets.find(scan.faces[f][0])];
    if (n < 0) n = int(flecks.box.size()), flecks.box.emplace_back(), flecks.faces.emplace_back();
    flecks.faces[n].push_back(f);
    flecks.box[n].extend(scan.face_box(f));
  }
  return flecks;
}

/// Unites what lies so near together that the surroundings of one reach the
/// other, until nothing does: in rounds, each a sweep along x.
DisjointSets neighbours(std::vector<Box> bare, double margin, Progress& progress) {
  DisjointSets sets(int(bare.size()));
  std::vector<int> alone(bare.size());
  std::iota(alone.begin(), alone.end(), 0);
  for (bool merged = true; merged;) {
    merged = false;
    std::vector<Box> wide(bare.size());
    for (int i : alone) wide[i] = with_margin(bare[i], margin);
    std::sort(alone.begin(), alone.end(), [&](int a, int b) {
      return wide[a].min().x() != wide[b].min().x() ? wide[a].min().x() < wide[b].min().x() : a < b;
    });
    for (std::size_t i = 0; i < alone.size(); ++i) {
      if (i % 256 == 0) progress.at(0);
      const int a = alone[i];
      for (std::size_t j = i + 1; j < alone.size() && wide[alone[j]].min().x() <= wide[a].max().x(); ++j) {
        const int b = alone[j];
        if (sets.find(a) == sets.find(b) || !(wide[a].intersects(bare[b]) || wide[b].intersects(bare[a]))) continue;
        sets.unite(a, b);
        merged = true;
      }
    }
    std::vector<int> roots;
    for (int i : alone)
      if (const int root = sets.find(i); root == i)
        roots.push_back(i);
      else
        bare[root].extend(bare[i]);
    alone = std::move(roots);
  }
  return sets;
}

/// Per group of flecks, the one whose far side it is; -1: it is a flaw of its own.
std::vector<int> far_sides(const Sheets& sheets, const std::vector<std::vector<int>>& groups) {
  constexpr std::size_t kMostGroups = 32;  // more are no selection drawn once
  std::vector<int> of(groups.size(), -1);
  if (groups.size() > kMostGroups) return of;
  for (std::size_t far = 0; far < groups.size(); ++far)
    for (std::size_t near = 0; near < groups.size() && of[far] < 0; ++near)
      if (near != far && of[near] < 0 && sheets.is_far_side(sheets.flaw_of(groups[far]), sheets.flaw_of(groups[near])))
        of[far] = int(near);
  return of;
}

/// The region around flecks that are mended together.
Region around_group(const Flecks& flecks, const std::vector<int>& group, const std::vector<char>& left_out,
                    double margin) {
  Region region;
  Box bare;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const std::vector<int>& faces = flecks.faces[group[k]];
    std::vector<int>& to = left_out[k] ? region.not_meant : region.flaw;
    to.insert(to.end(), faces.begin(), faces.end());
    if (!left_out[k]) bare.extend(flecks.box[group[k]]);
  }
  std::sort(region.flaw.begin(), region.flaw.end()), std::sort(region.not_meant.begin(), region.not_meant.end());
  region.box = with_margin(bare, margin);
  return region;
}

/// The regions around flecks; those whose surroundings overlap are mended together.
std::vector<Region> united(const Scan& scan, const Flecks& flecks, double margin, Progress& progress) {
  DisjointSets sets = neighbours(flecks.box, margin, progress);
  std::vector<std::vector<int>> groups;
  std::vector<int> number(flecks.box.size(), -1);
  for (int i = 0; i < int(flecks.box.size()); ++i) {
    int& n = number[sets.find(i)];
    if (n < 0) n = int(groups.size()), groups.emplace_back();
    groups[n].push_back(i);
  }
  const Sheets sheets(scan, flecks.faces);
  const std::vector<int> far_side_of = far_sides(sheets, groups);
  std::vector<Region> regions;
  std::vector<int> region_of(groups.size(), -1);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (far_side_of[g] >= 0) continue;
    region_of[g] = int(regions.size());
    regions.push_back(around_group(flecks, groups[g], sheets.not_meant(groups[g]), margin));
  }
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (far_side_of[g] >= 0 && region_of[far_side_of[g]] >= 0)
      for (int s : groups[g]) {
        std::vector<int>& to = regions[region_of[far_side_of[g]]].not_meant;
        to.insert(to.end(), flecks.faces[s].begin(), flecks.faces[s].end());
      }
  return regions;
}

/// Which holes the user means.
class HoleChoice {
 public:
  HoleChoice(const Mesh& scan, const std::vector<mesh::Loop>& rims, const RegionOptions& options);
  bool operator()(const mesh::Loop& rim) const;
  /// Around the hole, and what the user drew.
  Box box_around(const mesh::Loop& rim) const {
    Box around = with_margin(box_of(scan_, rim), by_ == RegionBy::Box ? 0 : options_.margin);
    if (by_ == RegionBy::Box) around.extend(box_);
    return around;
  }

 private:
  bool is_selected(const mesh::Loop& rim) const {
    return std::any_of(rim.begin(), rim.end(), [&](int v) { return at_selection_[v] != 0; });
  }
  double share_inside(const mesh::Loop& rim, const Box& b) const {
    return double(std::count_if(rim.begin(), rim.end(), [&](int v) { return b.contains(scan_.vertices[v]); })) /
           rim.size();
  }
  bool by_selection(const mesh::Loop& rim) const {
    // Faces selected all around a hole, not at its very rim, mean it as well.
    return beside_ ? is_selected(rim) : share_inside(rim, selection_) == 1;
  }

  const Mesh& scan_;
  const RegionOptions& options_;
  RegionBy by_;
  bool leave_selected_;
  Box box_, selection_;
  std::vector<char> at_selection_;  ///< per vertex
  bool beside_ = false;             ///< a selected face lies at a rim
};

HoleChoice::HoleChoice(const Mesh& scan, const std::vector<mesh::Loop>& rims, const RegionOptions& options)
    : scan_(scan),
      options_(options),
      by_(options.by),
      leave_selected_(options.leave_selected && options.by == RegionBy::Holes),
      at_selection_(scan.vertices.size(), 0) {
  if (by_ == RegionBy::Box) box_ = checked_box(scan, options);
  const std::vector<char> selected = selected_faces(scan);
  for (int f = 0; f < scan.face_count(); ++f)
    if (selected[f]) {
      selection_.extend(scan.face_box(f));
      for (int v : scan.faces[f]) at_selection_[v] = 1;
    }
  if (by_ == RegionBy::Selection && selection_.isEmpty())
    throw UserError("No face is selected; select some faces beside the hole, or choose Around all holes.");
  beside_ = std::any_of(rims.begin(), rims.end(), [&](const mesh::Loop& rim) { return is_selected(rim); });
  if (by_ == RegionBy::SelectedOrAll) {
    const bool any = !selection_.isEmpty() &&
                     std::any_of(rims.begin(), rims.end(), [&](const mesh::Loop& rim) { return by_selection(rim); });
    by_ = any ? RegionBy::Selection : RegionBy::Holes;
  }
}

bool HoleChoice::operator()(const mesh::Loop& rim) const {
  if (by_ == RegionBy::Selection) return by_selection(rim);
  if (by_ == RegionBy::Box) return share_inside(rim, box_) > 0.5;
  return !(leave_selected_ && is_selected(rim)) &&
         !(options_.longest_rim > 0 && mesh::loop_length(scan_, rim) > options_.longest_rim) &&
         !(options_.largest_hole > 0 && rim.size() > options_.largest_hole);
}

}  // namespace

std::vector<char> flaw_flags(const Scan& scan, const Region& region) {
  std::vector<char> flags;
  if (region.flaw.empty()) return flags;
  for (int o : scan.origin()) flags.push_back(o >= 0 && std::binary_search(region.flaw.begin(), region.flaw.end(), o));
  return flags;
}

std::vector<Region> flaw_regions(const Scan& scan, const RegionOptions& options, Progress& progress) {
  const Mesh& mesh = scan.mesh();
  check_scan(mesh);
  if (options.by == RegionBy::Holes) return hole_regions(scan, options);
  if (options.by == RegionBy::Box) return {Region{checked_box(mesh, options), {}, {}, {}}};
  const std::vector<char> selected = selected_faces(mesh);
  const Flecks flecks = flecks_of(mesh, selected);
  if (flecks.box.empty() && options.by == RegionBy::SelectedOrAll) return hole_regions(scan, options);
  if (flecks.box.empty())
    throw UserError("No face is selected; select the damaged faces, or give the region as a box.");
  if (std::count(selected.begin(), selected.end(), 1) == long(mesh.faces.size()))
    throw UserError("Every face is selected, so that no good surface is left to go by; select the damaged faces only.");
  return united(scan, flecks, options.margin, progress);
}

std::vector<Region> hole_regions(const Scan& scan, const RegionOptions& options) {
  const Mesh& mesh = scan.mesh();
  check_scan(mesh);
  const std::vector<mesh::Loop> rims = rims_of_surfaces(scan);
  if (rims.empty() && scan.chains() > 0)
    throw UserError(
        "The scan's open borders end at edges of more than two faces and bound no hole; remove the extra faces there "
        "(Select Non Manifold Edges shows them).");
  if (rims.empty())
    throw UserError("The scan has no hole; choose a layer with an open border, or use Restore Surface.");
  const HoleChoice wanted(mesh, rims, options);
  std::vector<Region> regions;
  std::vector<double> length;
  for (const mesh::Loop& rim : rims)
    if (wanted(rim))
      regions.push_back({wanted.box_around(rim), {}, {rim}, {}}), length.push_back(loop_length(mesh, rim));
  if (regions.empty()) {
    if (options.by == RegionBy::Box)
      throw UserError("There is no hole in the region; move or enlarge the box so that it holds the hole's whole rim.");
    if (options.by == RegionBy::Selection)
      throw UserError("No selected face lies beside a hole; select faces at its rim, or choose Around all holes.");
    throw UserError("All " + std::to_string(rims.size()) +
                    " holes are left out by their size or by the selection; raise LongestRim and LargestHole, or "
                    "select less.");
  }
  std::vector<int> order(regions.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return length[a] > length[b]; });
  std::vector<Region> sorted;
  for (int i : order) sorted.push_back(std::move(regions[i]));
  return sorted;
}

}  // namespace parts::mend
