// SPDX-License-Identifier: GPL-3.0-or-later
// Holes filled and scars restored, leave one out: the RMS distance to the
// surface that was there, beside MeshLab's Close Holes and Screened Poisson and
// CGAL's triangulate, refine and fair.
//   bench_fill [CLASS] [OPTION=VALUE ...]
//     CLASS     heads, head_shapes, busts, heads_bent (by 0.05 units) or head_scan; all if none is named
//     every=1   only every so many-th member
//     case=     only cases whose name has this in it
//     blend=    models blended; the filters' default if not given
//     thesis=0  1: pasted as in the thesis too, not fitted
//     rivals=1  0: without the others
//     itself=1  0: not from the scan itself, too; 2: not from the database
//     each=0    1: each member's error, and where its patch is from, too
//     keep=     a folder for the meshes

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "bench/fill_cases.h"
#include "bench/measure.h"
#include "bench/rivals.h"
#include "parts/io/mesh_io.h"
#include "parts/io/mlp_project.h"
#include "parts/mend/mend.h"
#include "parts/spatial/closest_face.h"

namespace {

using namespace parts;
using namespace parts::bench;
namespace fs = std::filesystem;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// All holes with their rim's start in the box, triangulated, refined and faired.
Mesh fair_fill(const Mesh& scan, const Box& box) {
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

/// Of the distances from what was there: all of it, and what shows from outside.
struct Error {
  double all = 0, outer = 0;
};

Error error_of(const Damaged& d, const Mesh& mesh) {
  const spatial::ClosestFace closest(mesh);
  double sum = 0, outer = 0;
  long count = 0;
  for (std::size_t i = 0; i < d.truth.size(); ++i) {
    const double square = std::pow(closest(d.truth[i]).distance, 2);
    sum += square;
    if (d.outer[i]) outer += square, ++count;
  }
  return {std::sqrt(sum / double(d.truth.size())), std::sqrt(outer / double(std::max(1L, count)))};
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v.empty() ? NAN : (v[(v.size() - 1) / 2] + v[v.size() / 2]) / 2;
}

class Bench {
 public:
  Bench(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
      const std::string word = argv[i];
      const auto equals = word.find('=');
      if (equals == std::string::npos)
        only_ = word;
      else
        value_[word.substr(0, equals)] = word.substr(equals + 1);
    }
    fs::create_directories(work_);
  }
  bool wanted(const std::string& name) const { return only_.empty() || only_ == name; }
  const std::string& work() const { return work_; }
  void measure(const MemberClass& members);

 private:
  std::string value(const std::string& name, const std::string& usual) const {
    const auto at = value_.find(name);
    return at == value_.end() ? usual : at->second;
  }
  void keep(const std::string& name, const Mesh& mesh) const {
    if (const std::string folder = value("keep", ""); !folder.empty()) {
      fs::create_directories(folder);
      io::write_mesh(mesh, folder + "/" + name + ".ply");
    }
  }
  void measure(const MemberClass& members, const DamageCase& what, Table& holes, Table& flaws) const;
  enum class From { Database, Thesis, Itself };
  Mesh mend(const MemberClass& members, std::size_t which, const DamageCase& what, const Damaged& damaged,
            From from) const;

  std::string only_, work_ = (fs::current_path() / "fill").string();
  std::map<std::string, std::string> value_;
};

Mesh Bench::mend(const MemberClass& members, std::size_t which, const DamageCase& what, const Damaged& damaged,
                 From from) const {
  mend::MendOptions options;
  options.fill = what.kind == DamageCase::Hole;
  options.region = damaged.region;
  if (const int blend = std::stoi(value("blend", "0")); blend > 0) options.restore.fitting.blend = blend;
  options.search.candidates = options.restore.tries;
  options.restore.fitting.fit_to_rim = from != From::Thesis;
  if (from == From::Thesis) options.restore.fitting.blend = 1;
  Progress silent;
  if (from == From::Itself) {
    const bool each = value("each", "0") == "1";
    Progress logging({}, [&](const std::string& line) {
      if (each) std::fprintf(stderr, "  %s\n", line.c_str());
    });
    const mend::Mended mended = mend::mend_scan(damaged.scan, nullptr, options, logging);
    for (const mend::Found& f : mended.candidates) logging.log(f.name);
    logging.log(mend::summary(mended, options.fill));
    return mended.mesh;
  }
  io::MlpProject project;
  const auto add = [&](const std::string& file) {
    project.meshes.push_back({fs::path(file).stem().string(), file, Eigen::Matrix4d::Identity()});
  };
  for (const std::string& file : members.models)
    if (file != members.members[which].file) add(file);
  for (std::size_t i = 0; members.models.empty() && i < members.members.size(); ++i)
    if (i != which) add(members.members[i].file);
  const std::string mlp = work_ + "/" + members.name + "_without_" + std::to_string(which) + ".mlp";
  io::write_mlp(project, mlp);
  const io::ModelDatabase database(mlp, silent);
  return mend::mend_scan(damaged.scan, &database, options, silent).mesh;
}

void Bench::measure(const MemberClass& members, const DamageCase& what, Table& holes, Table& flaws) const {
  const bool hole = what.kind == DamageCase::Hole, rivals = hole && value("rivals", "1") == "1";
  const bool thesis = value("thesis", "0") == "1";
  std::vector<double> close, fair, poisson, before, after, pasted, outer, ratio, outer_ratio, seconds, own;
  int failed = 0, own_failed = 0, count = 0;
  const int itself = std::stoi(value("itself", "1"));
  for (std::size_t i = 0; i < members.members.size(); i += std::size_t(std::stoi(value("every", "1")))) {
    const Member& member = members.members[i];
    const Damaged d = damage(member, what, unsigned(i));
    const double unit = member.unit / 100;
    const std::string name = fs::path(member.file).stem().string() + "_" + what.name;
    keep(name + "_scan", d.scan);
    ++count;
    Error base;
    if (hole) {
      const auto other = [&](const char* by, std::vector<double>& errors, const std::function<Mesh()>& run) {
        try {
          const Mesh mesh = run();
          keep(name + "_" + by, mesh);
          const Error e = error_of(d, mesh);
          errors.push_back(e.all / unit);
          if (base.all == 0 || e.all < base.all) base.all = e.all;
          if (base.outer == 0 || e.outer < base.outer) base.outer = e.outer;
        } catch (const std::exception& e) {
          std::fprintf(stderr, "%s: %s\n", name.c_str(), e.what());
        }
      };
      other("fair", fair, [&] { return fair_fill(d.scan, d.region.box); });
      if (rivals) {
        other("close", close, [&] { return close_holes(d.scan, work_); });
        other("poisson", poisson, [&] { return screened_poisson(d.scan, work_); });
      }
    } else {
      base = error_of(d, d.scan);
    }
    const auto left = [&](From from, const char* by, int& failures) {
      try {
        const Mesh mesh = mend(members, i, what, d, from);
        keep(name + "_" + by, mesh);
        return error_of(d, mesh);
      } catch (const UserError& e) {
        std::fprintf(stderr, "%s, %s: %s\n", name.c_str(), by, e.what());
        ++failures;
        return base;
      }
    };
    // Of those that were mended.
    if (const int before_it = own_failed; itself) {
      const Error e = left(From::Itself, "itself", own_failed);
      if (own_failed == before_it) own.push_back(e.all / unit);
      if (value("each", "0") == "1" && own_failed == before_it)
        std::fprintf(stderr, "%s, itself: %.3g of %.3g\n", name.c_str(), e.all / unit, base.all / unit);
    }
    if (itself == 2) continue;
    const Stopwatch watch;
    const Error ours = left(From::Database, "ours", failed);
    seconds.push_back(watch.cpu());
    before.push_back(base.all / unit), after.push_back(ours.all / unit), outer.push_back(ours.outer / unit);
    ratio.push_back(ours.all / base.all), outer_ratio.push_back(ours.outer / base.outer);
    int not_counted = 0;
    if (thesis) pasted.push_back(left(From::Thesis, "thesis", not_counted).all / unit);
    if (value("each", "0") == "1")
      std::fprintf(stderr, "%s: %.3g of %.3g\n", name.c_str(), ours.all / unit, base.all / unit);
  }
  figure((hole ? "fill: " : "restore: ") + members.name + ", " + what.name +
             (hole ? ", error of the best filler's" : ", error of the damage"),
         Better::Lower, median(ratio));
  const auto all = [](const std::vector<double>& v) { return v.empty() ? std::string("-") : text(median(v)); };
  std::vector<std::string> row{what.name, std::to_string(count)};
  if (hole)
    for (const auto& v : {close, fair, poisson}) row.push_back(all(v));
  else
    row.push_back(all(before));
  const double target = hole ? 0.35 : 0.3;
  row.push_back(all(own) + (own_failed ? " (" + std::to_string(own_failed) + " left)" : ""));
  for (const auto& v : {pasted, after, outer, ratio}) row.push_back(all(v));
  row.push_back(verdict(median(ratio) <= target));
  row.push_back(all(outer_ratio));
  row.push_back(ratio.empty() ? "-" : text(*std::max_element(ratio.begin(), ratio.end())));
  row.push_back(std::to_string(failed)), row.push_back(all(seconds));
  (hole ? holes : flaws).row(row);
}

void Bench::measure(const MemberClass& members) {
  if (members.members.size() < 4 && members.models.empty()) {
    std::printf("Skipped: no %s in '%s'.\n", members.name.c_str(), PARTS_DATA);
    return;
  }
  const std::vector<std::string> rest{"Itself", "As in the thesis", "Ours",  "Outside", "Of it",
                                      "",       "Outside",          "Worst", "Failed",  "Processor s"};
  std::vector<std::string> holes{"Holes", "Members", "Close Holes", "Fair fill", "Poisson"};
  std::vector<std::string> flaws{"Flaws", "Members", "Damage"};
  holes.insert(holes.end(), rest.begin(), rest.end()), flaws.insert(flaws.end(), rest.begin(), rest.end());
  holes[9] = "Of the best", flaws[7] = "Of the damage";
  const std::string unit = ", RMS distance to what was there, hundredths of the eyes' distance";
  Table hole_table(members.name + unit, holes), flaw_table(members.name + unit, flaws);
  for (const DamageCase& c : kDamageCases)
    if (std::string(c.name).find(value("case", "")) != std::string::npos) measure(members, c, hole_table, flaw_table);
  hole_table.note("Medians. Of the best: of the least error of the three, a member. Target: 0.35.");
  hole_table.note("Outside: only what shows from outside, so without nostrils and mouth.");
  hole_table.note("Itself: without a database, of those that were not left as they were.");
  flaw_table.note("Target: 0.3 of the damage.");
}

}  // namespace

int main(int argc, char** argv) {
  Bench bench(argc, argv);
  if (bench.wanted("heads")) bench.measure(heads(PARTS_DATA));
  if (bench.wanted("head_shapes")) bench.measure(head_shapes(PARTS_DATA));
  if (bench.wanted("heads_bent")) bench.measure(bent(heads(PARTS_DATA), 0.05));
  if (bench.wanted("head_scan")) bench.measure(head_scan(PARTS_DATA));
  if (bench.wanted("busts")) bench.measure(busts(bench.work(), 12));
}
