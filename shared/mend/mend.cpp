// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/mend.h"

#include <algorithm>

#include "parts/mesh/attributes.h"
#include "parts/mesh/pinches.h"
#include "parts/mesh/prepare.h"
#include "parts/mesh/topology.h"

namespace parts::mend {
namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

std::vector<search::Candidate> search(const Mesh& scan, const Region& region, const io::ModelDatabase& database,
                                      const search::SearchOptions& options, search::SearchMemory& memory,
                                      Progress& progress) {
  search::SearchQuery query{scan, region.box, {}};
  if (!region.flaw.empty())
    for (char flaw : region.flaw) query.face_weight.push_back(flaw ? 0.f : 1.f);
  return search::find_similar(query, database, options, progress, &memory);
}

/// Closes holes of so few edges that no detail fits into them at the scan's own
/// resolution: by a face, or a fan around their middle. @return how many
int close_small(Mesh& scan, std::vector<Region>& regions) {
  constexpr int kMostEdges = 6;
  std::vector<int> like(scan.vertices.size(), -1);
  for (int f = 0; f < scan.face_count(); ++f)
    for (int v : scan.faces[f]) like[v] = f;
  std::vector<Region> rest;
  int closed = 0;
  for (Region& region : regions) {
    const std::vector<int>& rim = region.rims[0].vertices;
    const int n = int(rim.size());
    if (n > kMostEdges) {
      rest.push_back(std::move(region));
      continue;
    }
    ++closed;
    if (n == 3) {
      mesh::add_face_like(scan, like[rim[0]], {rim[2], rim[1], rim[0]});
      continue;
    }
    Vec3 middle = Vec3::Zero();
    for (int v : rim) middle += scan.vertices[v] / n;
    const int center = mesh::add_vertex_between(scan, rim[0], rim[n / 2], 0.5);
    scan.vertices[center] = middle;
    for (int k = 0; k < n; ++k) mesh::add_face_like(scan, like[rim[k]], {rim[(k + 1) % n], rim[k], center});
  }
  regions = std::move(rest);
  return closed;
}

std::vector<Region> regions_of(const Mesh& scan, const MendOptions& options) {
  return options.fill ? hole_regions(scan, options.region) : flaw_regions(scan, options.region);
}

/// The region in a scan that has changed since: by the edges of its rims, and
/// where its flawed faces are. Nothing if it is gone.
bool find_again(Region& region, const Mesh& before, const Mesh& now) {
  if (!region.flaw.empty()) {
    // Faces outside the regions mended so far are as they were.
    std::vector<std::array<Vec3, 3>> flawed;
    const auto less = [](const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
      for (int k = 0; k < 3; ++k)
        for (int d = 0; d < 3; ++d)
          if (a[k][d] != b[k][d]) return a[k][d] < b[k][d];
      return false;
    };
    for (int f = 0; f < before.face_count(); ++f)
      if (region.flaw[f]) flawed.push_back({before.corner(f, 0), before.corner(f, 1), before.corner(f, 2)});
    std::sort(flawed.begin(), flawed.end(), less);
    region.flaw.assign(now.faces.size(), 0);
    bool any = false;
    for (int f = 0; f < now.face_count(); ++f)
      if (std::binary_search(flawed.begin(), flawed.end(),
                             std::array<Vec3, 3>{now.corner(f, 0), now.corner(f, 1), now.corner(f, 2)}, less))
        region.flaw[f] = 1, any = true;
    return any;
  }
  if (region.rims.empty()) return true;
  region.rims = rims_left(now, before, region.rims);
  return !region.rims.empty();
}

void log_region(const RestoreReport& r, const std::vector<search::Candidate>& found, const io::ModelDatabase& database,
                Progress& progress) {
  for (std::size_t i = 0; i < found.size(); ++i)
    progress.log("candidate_" + std::to_string(i + 1) + ": " + database.name(found[i].model) + " " +
                 number(found[i].score));
  progress.log("model: " + database.name(found[r.model].model));
  const auto log = [&](const char* name, double value) { progress.log(std::string(name) + ": " + number(value)); };
  log("blended", r.blended);
  log("rms_before", r.rms_before), log("rms_after", r.rms_after), log("inlier_share", r.inlier_share);
  log("faces_replaced", r.faces_replaced), log("faces_added", r.faces_added);
  log("rims_joined", r.rims_joined), log("borders_capped", r.borders_capped);
  log("islands_dropped", r.islands_dropped);
  log("seam_length", r.seam_length), log("seam_gap", r.seam_gap);
}

/// Without crumbs: small pieces, hardly more than a rim, that hung on the rest
/// in vertices only.
/// @param first  vertices from here on are copies
Mesh without_crumbs(const Mesh& mesh, const std::vector<int>& copies, int first) {
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
  return mesh::take_faces(mesh, keep);
}

/// Fit for finding rims: where one touches itself in a vertex, as the teeth of a
/// torn border do, its corners get vertices of their own.
Mesh prepared(const Mesh& input) {
  Mesh mesh = mesh::prepare(input).mesh;
  const int first = mesh.vertex_count();
  const std::vector<int> copies = mesh::split_pinches(mesh, std::vector<char>(mesh.vertices.size(), 1));
  return copies.empty() ? mesh : without_crumbs(mesh, copies, first);
}

}  // namespace

Mesh placed(Mesh mesh, const Eigen::Affine3d& placement) {
  const Eigen::Matrix3f turn = placement.linear().cast<float>();
  for (Vec3& v : mesh.vertices) v = placement * v;
  for (Eigen::Vector3f& n : mesh.vertex_normal) n = (turn * n).normalized();
  return mesh;
}

std::vector<Found> find_models(const Mesh& input, const io::ModelDatabase& database, const MendOptions& options,
                               Progress& progress) {
  const Mesh scan = prepared(input);
  const std::vector<Region> regions = regions_of(scan, options);
  std::vector<Found> all;
  search::SearchMemory memory;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    Progress part = progress.part(int(100 * i / regions.size()), int(100 * (i + 1) / regions.size()));
    progress.log("region: " + std::to_string(i + 1) + "/" + std::to_string(regions.size()));
    const std::vector<search::Candidate> found = search(scan, regions[i], database, options.search, memory, part);
    for (std::size_t k = 0; k < found.size(); ++k) {
      const search::Candidate& c = found[k];
      progress.log("candidate_" + std::to_string(k + 1) + ": " + database.name(c.model) + " " + number(c.score));
      all.push_back({int(i), placed(database.load(c.model), c.placement), database.name(c.model), c.score});
    }
  }
  return all;
}

Mended mend_scan(const Mesh& input, const io::ModelDatabase& database, const MendOptions& options, Progress& progress) {
  Mended out;
  Mesh first = prepared(input);
  std::vector<Region> regions = regions_of(first, options);
  out.regions = int(regions.size());
  if (options.fill) {
    out.mended = close_small(first, regions);
    if (out.mended) progress.log("closed_small: " + std::to_string(out.mended));
  }
  out.mesh = first;
  // More are blended than are tried as the base.
  search::SearchOptions search_options = options.search;
  RestoreOptions restore_options = options.restore;
  restore_options.tries = options.search.candidates;
  if (options.restore.fit_to_rim)
    search_options.candidates = std::max(search_options.candidates, options.restore.blend);
  std::string failure;
  search::SearchMemory memory;
  // Whether the region is whole now; from and to are per cent of the progress.
  const auto mend = [&](std::size_t i, int from, int to) {
    progress.log("region: " + std::to_string(i + 1) + "/" + std::to_string(regions.size()));
    Region region = regions[i];
    if (!find_again(region, first, out.mesh)) {
      progress.log("mended_before: 1");  // the patch of another hole reached it
      return true;
    }
    try {
      const int middle = from + (to - from) / 2;
      Progress searching = progress.part(from, middle);
      const std::vector<search::Candidate> found =
          search(out.mesh, region, database, search_options, memory, searching);
      std::vector<PlacedModel> models;
      for (const search::Candidate& c : found)
        models.push_back({placed(database.load(c.model), c.placement), database.name(c.model)});
      Progress mending = progress.part(middle, to);
      mending.stage(options.fill ? "Filling" : "Restoring", 0, 100);
      Restored r = options.fill ? fill_hole(out.mesh, region, models, restore_options, mending)
                                : restore_surface(out.mesh, region, models, restore_options, mending);
      log_region(r.report, found, database, progress);
      out.mesh = std::move(r.mesh);
      const search::Candidate& used = found[r.report.model];
      out.candidates.push_back({int(i), std::move(r.candidate), database.name(used.model), used.score});
      return true;
    } catch (const UserError& e) {
      failure = e.what();
      if (out.regions > 1) progress.log("left_as_it_was: " + failure);
      return false;
    }
  };
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < regions.size(); ++i)
    if (mend(i, int(90 * i / regions.size()), int(90 * (i + 1) / regions.size())))
      ++out.mended;
    else
      left.push_back(i);
  // Once more, now that what lies beside them may be whole.
  if (left.size() < regions.size())
    for (std::size_t i : left) out.mended += mend(i, 90, 100);
  if (out.mended == 0) throw UserError(failure);
  return out;
}

}  // namespace parts::mend
