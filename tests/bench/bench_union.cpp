// SPDX-License-Identifier: GPL-3.0-or-later
// Composition beside two boolean unions, where a union answers the same
// question: CGAL's corefinement and MeshLab's own CSG filter.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/intersection.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <stdio.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "bench/measure.h"
#include "bench/scenes.h"
#include "bench/seam_quality.h"
#include "parts/compose/constraint.h"

using namespace parts;
using namespace parts::bench;
namespace PMP = CGAL::Polygon_mesh_processing;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

CgalMesh to_cgal(const Mesh& mesh) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> faces;
  for (const Vec3& p : mesh.vertices) points.emplace_back(p[0], p[1], p[2]);
  for (const Triangle& f : mesh.faces) faces.push_back({std::size_t(f[0]), std::size_t(f[1]), std::size_t(f[2])});
  PMP::orient_polygon_soup(points, faces);
  CgalMesh out;
  PMP::polygon_soup_to_polygon_mesh(points, faces, out);
  return out;
}

Mesh from_cgal(CgalMesh mesh) {
  mesh.collect_garbage();
  Mesh out;
  for (auto v : mesh.vertices()) out.vertices.emplace_back(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
  for (auto f : mesh.faces()) {
    Triangle t;
    int k = 0;
    for (auto v : CGAL::vertices_around_face(mesh.halfedge(f), mesh)) t[k++] = int(v);
    out.faces.push_back(t);
  }
  return out;
}

Mesh read_off(const std::string& path) {
  std::ifstream in(path);
  std::string word;
  int vertices = 0, faces = 0, edges = 0;
  in >> word >> vertices >> faces >> edges;
  Mesh mesh;
  mesh.vertices.resize(vertices);
  for (Vec3& p : mesh.vertices) in >> p[0] >> p[1] >> p[2];
  for (int f = 0; f < faces && in; ++f) {
    std::string rest;
    int corners = 0;
    Triangle t;
    in >> corners >> t[0] >> t[1] >> t[2];
    std::getline(in, rest);
    mesh.faces.push_back(t);
  }
  if (!in || mesh.faces.empty()) throw std::runtime_error("cannot read " + path);
  return mesh;
}

void write_off(const Mesh& mesh, const std::string& path) {
  std::ofstream out(path);
  out.precision(9);
  out << "OFF\n" << mesh.vertex_count() << " " << mesh.face_count() << " 0\n";
  for (const Vec3& p : mesh.vertices) out << p[0] << " " << p[1] << " " << p[2] << "\n";
  for (const Triangle& f : mesh.faces) out << "3 " << f[0] << " " << f[1] << " " << f[2] << "\n";
}

struct Outcome {
  Mesh mesh;
  Times times;
};

Outcome ours(const Scene& scene) {
  Outcome o;
  Progress silent;
  o.times = best_of([&] { o.mesh = compose::compose(scene.a, scene.b, {}, silent).composed; });
  return o;
}

Outcome with_cgal(const Scene& scene) {
  const CgalMesh a = to_cgal(scene.a.mesh), b = to_cgal(scene.b.mesh);
  CgalMesh sum;
  bool good = true;
  const Times copies = best_of([&] { const CgalMesh first = a, second = b; });
  Outcome o;
  o.times = best_of([&] {
    CgalMesh first = a, second = b;  // corefinement changes its inputs
    sum.clear();
    good = PMP::corefine_and_compute_union(first, second, sum);
  });
  o.times.wall -= copies.wall, o.times.cpu -= copies.cpu;
  if (!good) throw std::runtime_error("no manifold union");
  o.mesh = from_cgal(sum);
  return o;
}

constexpr int kPatience = 120;  // seconds

void run_meshlab(const std::string& script, bool with_result) {
  const std::string command = "cd union && timeout " + std::to_string(kPatience) +
                              " '" SOURCE_DIR "/tools/headless' meshlabserver -i a.off b.off " +
                              (with_result ? "-o union.off " : "") + "-s " + script + " >meshlab.log 2>&1";
  const int status = std::system(command.c_str());
  if (WIFEXITED(status) && WEXITSTATUS(status) == 124)
    throw std::runtime_error("stopped after " + std::to_string(kPatience) + " s");
  if (status != 0 || (with_result && !std::filesystem::exists("union/union.off")))
    throw std::runtime_error("failed, see union/meshlab.log");
}

/// The filter's own defaults: samples a hundredth of the shortest side apart.
Outcome with_meshlab(const Scene& scene) {
  const double spacing =
      std::min(scene.a.mesh.bounds().sizes().minCoeff(), scene.b.mesh.bounds().sizes().minCoeff()) / 100;
  std::filesystem::create_directories("union");
  write_off(scene.a.mesh, "union/a.off"), write_off(scene.b.mesh, "union/b.off");
  std::ofstream("union/nothing.mlx") << "<!DOCTYPE FilterScript>\n<FilterScript/>\n";
  std::ofstream("union/union.mlx") << "<!DOCTYPE FilterScript>\n<FilterScript>\n <filter name=\"CSG Operation\">\n"
                                   << "  <Param type=\"RichMesh\" name=\"FirstMesh\" value=\"0\"/>\n"
                                   << "  <Param type=\"RichMesh\" name=\"SecondMesh\" value=\"1\"/>\n"
                                   << "  <Param type=\"RichAbsPerc\" name=\"Delta\" value=\"" << spacing
                                   << "\" min=\"0\" max=\"" << 100 * spacing << "\"/>\n"
                                   << "  <Param type=\"RichInt\" name=\"SubDelta\" value=\"32\"/>\n"
                                   << "  <Param type=\"RichEnum\" name=\"Operator\" value=\"1\" enum_cardinality=\"3\" "
                                   << "enum_val0=\"Intersection\" enum_val1=\"Union\" enum_val2=\"Difference\"/>\n"
                                   << " </filter>\n</FilterScript>\n";
  std::filesystem::remove("union/union.off");
  Outcome o;
  const Times start = best_of([] { run_meshlab("nothing.mlx", false); }, 2);
  o.times = best_of([] { run_meshlab("union.mlx", true); }, 2);
  o.times.wall -= start.wall, o.times.cpu = 0;
  o.mesh = read_off("union/union.off");
  return o;
}

Mesh demo_mesh(const char* name) {
  std::string path;
  FILE* pipe = popen((std::string("'" SOURCE_DIR "/tools/cgal-mesh' ") + name).c_str(), "r");
  for (int c; pipe && (c = fgetc(pipe)) != EOF && c != '\n';) path += char(c);
  if (pipe) pclose(pipe);
  return read_off(path);
}

/// A small man who grows out of a camel's hump from the thighs up.
Scene man_on_camel() {
  Mesh man = demo_mesh("man.off"), camel = demo_mesh("camel.off");
  for (Vec3& p : man.vertices) p = 0.35 * Vec3(p[0], p[2], -p[1]);
  move(man, {0, 0.453, -0.14});
  std::vector<char> torso = compose::constrained_faces(man, compose::ConstraintBy::Box, {-1, 0.5, -1}, {1, 1, 1}, "A");
  std::vector<char> legs =
      compose::constrained_faces(camel, compose::ConstraintBy::Box, {-1, -1, -1}, {1, 0.1, 1}, "B");
  return {"man on camel", {std::move(man), std::move(torso)}, {std::move(camel), std::move(legs)}};
}

/// Points along the curves in which the inputs cross, `step` apart at most.
std::vector<Vec3> crossing_curve(const Scene& scene, double step) {
  std::vector<std::vector<Kernel::Point_3>> lines;
  PMP::surface_intersection(to_cgal(scene.a.mesh), to_cgal(scene.b.mesh), std::back_inserter(lines));
  std::vector<Vec3> points;
  for (const auto& line : lines)
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const Vec3 p(line[i].x(), line[i].y(), line[i].z()), q(line[i + 1].x(), line[i + 1].y(), line[i + 1].z());
      const int steps = 1 + int((q - p).norm() / step);
      for (int k = 0; k < steps; ++k) points.push_back(p + (q - p) * k / steps);
    }
  return points;
}

std::string self_intersections(const Mesh& mesh) {
  std::vector<std::pair<CgalMesh::Face_index, CgalMesh::Face_index>> pairs;
  PMP::self_intersections(to_cgal(mesh), std::back_inserter(pairs));
  return count(double(pairs.size()));
}

void compare(const Scene& scene) {
  const double edge = 0.5 * (mean_edge(scene.a.mesh) + mean_edge(scene.b.mesh));
  const std::vector<Vec3> curve = crossing_curve(scene, 0.5 * edge);
  Table table(scene.name + ", " + count(scene.a.mesh.face_count()) + " and " + count(scene.b.mesh.face_count()) +
                  " faces, self-intersections " + self_intersections(scene.a.mesh) + " and " +
                  self_intersections(scene.b.mesh),
              {"Method", "Wall s", "Processor s", "Time to ours", "Faces", "Closed", "Self-intersections",
               "Input vertices", "Volume to CGAL's", "Seam faces", "Least angle", "Median angle", "Under 5°",
               "Edge ratio", "Dihedral RMS", "spread"});
  double our_time = 0, exact_volume = 0;
  try {
    exact_volume = volume(with_cgal(scene).mesh);
  } catch (const std::exception&) {
  }
  const auto row = [&](const char* method, Outcome (*run)(const Scene&)) {
    Outcome o;
    try {
      o = run(scene);
    } catch (const std::exception& e) {
      return table.row({method, e.what()});
    }
    if (our_time == 0) our_time = o.times.wall;
    const SeamQuality q = seam_quality(o.mesh, curve, edge);
    table.row({method, text(o.times.wall), o.times.cpu > 0 ? text(o.times.cpu) : "", ratio(o.times.wall / our_time),
               count(o.mesh.face_count()), verdict(closed_and_oriented(o.mesh)), self_intersections(o.mesh),
               text(100 * share_of_input_vertices(o.mesh, scene.a.mesh, scene.b.mesh)) + " %",
               exact_volume > 0 ? text(volume(o.mesh) / exact_volume, 4) : "", count(q.faces),
               text(q.least_angle) + "°", text(q.median_angle) + "°", text(100 * q.slivers) + " %", text(q.edge_ratio),
               text(q.dihedral_rms) + "°", text(q.dihedral_spread) + "°"});
    if (std::getenv("KEEP_MESHES")) write_off(o.mesh, scene.name + "_" + method + ".off");
  };
  row("compose", ours);
  row("CGAL union", with_cgal);
  row("MeshLab CSG", with_meshlab);
}

}  // namespace

int main() {
  for (const Scene& scene : {two_spheres(20000), two_tubes(20000), two_creatures(20000), man_on_camel()})
    compare(scene);
  std::cout
      << "\nSeam faces: those with a vertex within a mean edge of the curve in which the inputs cross. Dihedral\n"
         "angles are from flat. A union keeps the crease there; compose smooths it (SmoothIterations 3).\n"
         "MeshLab's time is meshlabserver's without that of an empty script, so saving is in it; its meshes come out\n"
         "inside out where the volume is negative.\n";
}
