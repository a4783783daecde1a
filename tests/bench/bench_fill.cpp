// SPDX-License-Identifier: GPL-3.0-or-later
// Holes filled and scars restored on a class of heads, leave one out: the RMS
// distance to the surface that was there, beside CGAL's fair fill.
//   bench_fill [EVERY] [BLEND]   every so many-th head (4); models blended (1)

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include "bench/measure.h"
#include "database/closest_face.h"
#include "database/mend.h"
#include "geometry/attributes.h"
#include "geometry/mesh_io.h"
#include "geometry/mlp_project.h"
#include "geometry/prepare.h"

namespace {

using namespace parts;
namespace fs = std::filesystem;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// A landmark of the JSON file beside a head.
Vec3 landmark(const fs::path& head, const std::string& name) {
  std::ifstream in(fs::path(head).replace_extension("json"));
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const auto at = text.find('[', text.find('"' + name + '"'));
  Vec3 p = Vec3::Zero();
  if (at != std::string::npos) std::sscanf(text.c_str() + at, "[ %lf, %lf, %lf", &p[0], &p[1], &p[2]);
  return p;
}

double rms(const std::vector<Vec3>& truth, const Mesh& mesh) {
  const ClosestFace closest(mesh);
  double sum = 0;
  for (const Vec3& p : truth) sum += std::pow(closest(p).distance, 2);
  return std::sqrt(sum / double(truth.size()));
}

/// All holes with their middle in the box, triangulated, refined and faired.
Mesh cgal_fill(const Mesh& scan, const Box& box) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> faces;
  for (const Vec3& v : scan.vertices) points.emplace_back(v.x(), v.y(), v.z());
  for (const Triangle& f : scan.faces) faces.push_back({std::size_t(f[0]), std::size_t(f[1]), std::size_t(f[2])});
  CgalMesh mesh;
  pmp::polygon_soup_to_polygon_mesh(points, faces, mesh);
  std::vector<CgalMesh::Halfedge_index> borders;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(borders));
  for (const auto border : borders) {
    const auto p = mesh.point(mesh.target(border));
    if (!box.contains(Vec3(p.x(), p.y(), p.z()))) continue;
    std::vector<CgalMesh::Face_index> new_faces;
    std::vector<CgalMesh::Vertex_index> new_vertices;
    pmp::triangulate_refine_and_fair_hole(mesh, border, std::back_inserter(new_faces),
                                          std::back_inserter(new_vertices));
  }
  Mesh out;
  for (const auto v : mesh.vertices())
    out.vertices.emplace_back(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
  for (const auto f : mesh.faces()) {
    Triangle t{};
    int k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) t[std::size_t(k++)] = int(v);
    out.faces.push_back(t);
  }
  return out;
}

/// Dents the surface and roughens it; the touched faces are selected.
Mesh scarred(const Mesh& whole, const Vec3& at, double radius, unsigned seed, std::vector<Vec3>& truth) {
  Mesh scan = whole;
  update_normals(scan);
  std::mt19937 random(seed);
  const auto noise = [&] { return double(random()) / 4294967296.0 - 0.5; };
  scan.face_selected.assign(scan.faces.size(), 0);
  std::vector<char> touched(scan.vertices.size(), 0);
  for (int v = 0; v < scan.vertex_count(); ++v) {
    const double r = (whole.vertices[v] - at).norm() / radius;
    if (r >= 1) continue;
    const double fall = std::pow(1 - r * r, 2);
    scan.vertices[v] += fall * (-0.12 * scan.vertex_normal[v].cast<double>() + 0.05 * Vec3(noise(), noise(), noise()));
    touched[v] = 1, truth.push_back(whole.vertices[v]);
  }
  for (int f = 0; f < scan.face_count(); ++f)
    for (int v : scan.faces[f]) scan.face_selected[f] |= touched[v];
  return scan;
}

struct Case {
  const char *name, *landmark;
  Vec3 offset;
  double radius;
  bool hole;
};
const Case kCases[] = {{"nose removed", "nose_tip", Vec3(0, 0, 0), 0.26, true},
                       {"crown removed", "crown", Vec3(0, 0, 0), 0.8, true},
                       {"nose broken", "nose_tip", Vec3(0, 0, 0), 0.28, false},
                       {"cheek scarred", "nose_tip", Vec3(0.35, -0.1, -0.25), 0.28, false}};

}  // namespace

int main(int argc, char** argv) {
  const int every = argc > 1 ? std::max(1, std::atoi(argv[1])) : 4, blend = argc > 2 ? std::atoi(argv[2]) : 1;
  const fs::path folder = fs::path(PARTS_DATA) / "heads";
  std::vector<fs::path> heads;
  if (fs::exists(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".obj") heads.push_back(entry.path());
  if (heads.size() < 4) {
    std::printf("Skipped: no heads in %s.\n", folder.c_str());
    return 0;
  }
  std::sort(heads.begin(), heads.end());
  const fs::path work = fs::current_path() / "fill_models";
  fs::create_directories(work);
  bench::Table table("RMS distance to what was there, " + std::to_string(blend) + " blended",
                     {"case", "heads", "fair fill or damage", "as in the thesis", "fitted", "median ratio", "largest",
                      "failed", "seconds"});
  for (const Case& c : kCases) {
    std::vector<double> base, pasted, fitted, ratio, seconds;
    int failed = 0;
    for (std::size_t q = 0; q < heads.size(); q += std::size_t(every)) {
      Mesh whole = prepare(read_mesh(heads[q].string())).mesh;
      whole.wedges.clear(), whole.textures.clear();
      MlpProject project;
      for (std::size_t i = 0; i < heads.size(); ++i)
        if (i != q)
          project.meshes.push_back({heads[i].stem().string(), heads[i].string(), Eigen::Matrix4d::Identity()});
      const std::string mlp = (work / ("without_" + std::to_string(q) + ".mlp")).string();
      write_mlp(project, mlp);
      const Vec3 at = landmark(heads[q], c.landmark) + c.offset;
      MendOptions options;
      options.fill = c.hole;
      options.search.any_rotation = false;
      options.search.candidates = std::max(5, blend);
      std::vector<Vec3> truth;
      Mesh scan;
      double before = 0;
      if (c.hole) {
        std::vector<char> stays(whole.faces.size()), gone(whole.faces.size());
        for (int f = 0; f < whole.face_count(); ++f)
          gone[f] = ((whole.corner(f, 0) + whole.corner(f, 1) + whole.corner(f, 2)) / 3 - at).norm() < c.radius,
          stays[f] = !gone[f];
        scan = take_faces(whole, stays);
        const Mesh removed = take_faces(whole, gone);
        truth = removed.vertices;
        options.region.by = RegionBy::Box;
        options.region.box = removed.bounds();
        options.region.margin = 0.1;
        Box box = removed.bounds();
        before = rms(truth, cgal_fill(scan, Box(box.min().array() - 0.1, box.max().array() + 0.1)));
      } else {
        scan = scarred(whole, at, c.radius, unsigned(q), truth);
        before = rms(truth, scan);
      }
      Progress silent;
      const ModelDatabase database(mlp, silent);
      const auto left = [&](bool fit) {
        options.restore.fit_to_rim = fit;
        options.restore.blend = fit ? blend : 1;
        try {
          return rms(truth, mend_scan(scan, database, options, silent).mesh);
        } catch (const UserError& e) {
          if (fit) ++failed, std::fprintf(stderr, "%s, %s: %s\n", c.name, heads[q].stem().c_str(), e.what());
          return before;
        }
      };
      const bench::Stopwatch watch;
      fitted.push_back(left(true));
      seconds.push_back(watch.wall());
      pasted.push_back(left(false));
      base.push_back(before), ratio.push_back(fitted.back() / before);
    }
    const auto median = [](std::vector<double> v) {
      std::sort(v.begin(), v.end());
      return bench::text(v[v.size() / 2]);
    };
    table.row({c.name, std::to_string(ratio.size()), median(base), median(pasted), median(fitted), median(ratio),
               bench::text(*std::max_element(ratio.begin(), ratio.end())), std::to_string(failed), median(seconds)});
  }
  table.note("Fair fill (holes): CGAL's triangulate_refine_and_fair_hole. Damage (scars): the scan as it was.");
  table.note("Targets: 0.35 of the fair fill, 0.3 of the damage.");
}
