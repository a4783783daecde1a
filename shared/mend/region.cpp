// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/region.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "parts/base/disjoint_sets.h"
#include "parts/base/error.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/topology.h"

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

std::vector<mesh::Loop> find_rims(const Mesh& scan) {
  std::vector<mesh::Loop> rims;
  const mesh::EdgeMap map = mesh::edge_map(scan);
  for (std::vector<int>& vertices : mesh::boundary_loops(scan, map)) {
    mesh::Loop rim{std::move(vertices), true};
    if (rim.size() >= 3) rims.push_back(std::move(rim));
  }
  return rims;
}

std::vector<mesh::Loop> rims_left(const Mesh& now, const Mesh& before, const std::vector<mesh::Loop>& rims) {
  const auto place = [](const Mesh& m, const mesh::Loop& l, int i) {
    return mesh::edge_place(m, l.vertices[i], l.vertices[(i + 1) % l.size()]);
  };
  std::set<mesh::EdgePlace> edges;
  for (const mesh::Loop& rim : rims)
    for (int i = 0; i < rim.size(); ++i) edges.insert(place(before, rim, i));
  std::vector<mesh::Loop> left;
  for (mesh::Loop& rim : find_rims(now)) {
    bool held = false;
    for (int i = 0; i < rim.size() && !held; ++i) held = edges.count(place(now, rim, i)) > 0;
    if (held) left.push_back(std::move(rim));
  }
  return left;
}

namespace {

/// Not the outlines of crumbs: loose pieces that are hardly more than a rim.
std::vector<mesh::Loop> rims_of_surfaces(const Mesh& scan, std::vector<mesh::Loop> rims) {
  const std::vector<int> component = mesh::vertex_components(scan);
  std::vector<int> faces(scan.vertices.size(), 0);
  for (const Triangle& f : scan.faces) ++faces[component[f[0]]];
  const int largest = faces.empty() ? 0 : *std::max_element(faces.begin(), faces.end());
  const auto crumb = [&](const mesh::Loop& rim) {
    const int own = faces[component[rim.vertices[0]]];
    return own <= rim.size() - 2 || (own <= 2 * rim.size() && own < largest);
  };
  rims.erase(std::remove_if(rims.begin(), rims.end(), crumb), rims.end());
  return rims;
}

}  // namespace

std::vector<Region> flaw_regions(const Mesh& scan, const RegionOptions& options) {
  check_scan(scan);
  if (options.by == RegionBy::Holes) return hole_regions(scan, options);
  if (options.by == RegionBy::Box) return {Region{checked_box(scan, options), {}, {}}};

  const std::vector<char> selected = selected_faces(scan);
  DisjointSets sets(scan.vertex_count());
  for (int f = 0; f < scan.face_count(); ++f)
    if (selected[f]) sets.unite(scan.faces[f][0], scan.faces[f][1]), sets.unite(scan.faces[f][0], scan.faces[f][2]);
  std::vector<Region> regions;
  std::vector<int> region_of(scan.vertices.size(), -1);
  std::vector<Box> bare;
  for (int f = 0; f < scan.face_count(); ++f) {
    if (!selected[f]) continue;
    int& r = region_of[sets.find(scan.faces[f][0])];
    if (r < 0)
      r = int(regions.size()), regions.push_back({Box(), std::vector<char>(scan.faces.size(), 0), {}}),
      bare.emplace_back();
    regions[r].flaw[f] = 1;
    bare[r].extend(scan.face_box(f));
  }
  if (regions.empty()) throw UserError("No face is selected; select the damaged faces, or give the region as a box.");
  if (std::count(selected.begin(), selected.end(), 1) == long(scan.faces.size()))
    throw UserError("Every face is selected, so that no good surface is left to go by; select the damaged faces only.");
  // Flaws whose surroundings overlap are mended together.
  for (bool merged = true; merged;) {
    merged = false;
    for (std::size_t i = 0; i < regions.size() && !merged; ++i)
      for (std::size_t j = i + 1; j < regions.size() && !merged; ++j)
        if (with_margin(bare[i], options.margin).intersects(bare[j]) ||
            with_margin(bare[j], options.margin).intersects(bare[i])) {
          for (std::size_t f = 0; f < scan.faces.size(); ++f) regions[i].flaw[f] |= regions[j].flaw[f];
          bare[i].extend(bare[j]);
          regions.erase(regions.begin() + long(j)), bare.erase(bare.begin() + long(j));
          merged = true;
        }
  }
  for (std::size_t i = 0; i < regions.size(); ++i) regions[i].box = with_margin(bare[i], options.margin);
  return regions;
}

std::vector<Region> hole_regions(const Mesh& scan, const RegionOptions& options) {
  check_scan(scan);
  const std::vector<mesh::Loop> rims = rims_of_surfaces(scan, find_rims(scan));
  if (rims.empty())
    throw UserError("The scan has no hole; choose a layer with an open border, or use Restore Surface.");
  const Box box = options.by == RegionBy::Box ? checked_box(scan, options) : Box();
  const std::vector<char> selected = selected_faces(scan);
  std::vector<char> at_selection(scan.vertices.size(), 0);
  Box selection;
  for (int f = 0; f < scan.face_count(); ++f)
    if (selected[f]) {
      selection.extend(scan.face_box(f));
      for (int v : scan.faces[f]) at_selection[v] = 1;
    }
  if (options.by == RegionBy::Selection && selection.isEmpty())
    throw UserError("No face is selected; select some faces beside the hole, or choose Around all holes.");
  const auto is_selected = [&](const mesh::Loop& rim) {
    return std::any_of(rim.vertices.begin(), rim.vertices.end(), [&](int v) { return at_selection[v] != 0; });
  };
  const auto share_inside = [&](const mesh::Loop& rim, const Box& b) {
    long inside = 0;
    for (int v : rim.vertices) inside += b.contains(scan.vertices[v]);
    return double(inside) / rim.size();
  };
  const bool beside = std::any_of(rims.begin(), rims.end(), is_selected);

  std::vector<Region> regions;
  int left = 0;
  for (const mesh::Loop& rim : rims) {
    bool wanted = false;
    if (options.by == RegionBy::Holes) {
      wanted = !(options.leave_selected && is_selected(rim)) &&
               !(options.longest_rim > 0 && mesh::loop_length(scan, rim) > options.longest_rim);
      left += !wanted;
    } else if (options.by == RegionBy::Selection) {
      // Faces selected all around a hole, not at its very rim, mean it as well.
      wanted = beside ? is_selected(rim) : share_inside(rim, selection) == 1;
    } else {
      wanted = share_inside(rim, box) > 0.5;
    }
    if (!wanted) continue;
    Box around = with_margin(box_of(scan, rim), options.by == RegionBy::Box ? 0 : options.margin);
    if (options.by == RegionBy::Box) around.extend(box);
    regions.push_back({around, {}, {rim}});
  }
  if (regions.empty()) {
    if (options.by == RegionBy::Box)
      throw UserError("There is no hole in the region; move or enlarge the box so that it holds the hole's whole rim.");
    if (options.by == RegionBy::Selection)
      throw UserError("No selected face lies beside a hole; select faces at its rim, or choose Around all holes.");
    throw UserError("All " + std::to_string(left) +
                    " holes are left out by their size or by the selection; raise the longest rim, or select less.");
  }
  std::vector<double> length;
  for (const Region& r : regions) length.push_back(mesh::loop_length(scan, r.rims[0]));
  std::vector<int> order(regions.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return length[a] > length[b]; });
  std::vector<Region> sorted;
  for (int i : order) sorted.push_back(std::move(regions[i]));
  return sorted;
}

}  // namespace parts::mend
