// SPDX-License-Identifier: GPL-3.0-or-later
// How good the seams are that the cuts make: the objective J with its parts,
// what the results are made of, seconds and memory, on the scenes of
// seam_scenes.h. `--out FOLDER` writes the results, coloured by their source,
// for tools/picture; a word takes only scenes whose name holds it.

#include <cmath>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "bench/measure.h"
#include "bench/seam_scenes.h"
#include "parts/cut/seam_score.h"
#include "parts/io/mesh_io.h"
#include "parts/mesh/self_intersections.h"
#include "parts/mesh/topology.h"

using namespace parts;
using namespace parts::bench;

namespace {

std::string file_name(const std::string& scene, const char* cut) {
  std::string name = scene + "-" + cut + ".ply";
  for (char& c : name)
    if (c == ' ' || c == '\'') c = '_';
  return name;
}

enum Figure { kJ, kGap, kLength, kTurn, kUnfaced, kPieces, kLoops, kBad, kCrossings, kSeconds, kFigures };

Child measured(const Scene& scene, cut::Cut cut, const std::string& out) {
  return in_child(
      [&] {
        compose::ComposeOptions options;
        options.cut = cut;
        Progress silent;
        const Stopwatch watch;
        compose::ComposeResult r = compose::compose(scene.a, scene.b, options, silent);
        const double seconds = watch.cpu();
        const double scale = std::min(cut::rms_size(scene.a.mesh), cut::rms_size(scene.b.mesh));
        const cut::SeamScore s = cut::score_seam(cut::borders_of(scene.a.mesh, r.clipped_a),
                                                 cut::borders_of(scene.b.mesh, r.clipped_b), scale);
        const mesh::MeshCheck check = mesh::check(r.composed);
        const double unit = cut::SeamScore::kLambda * scale * scale;
        std::vector<double> f(kFigures);
        f[kJ] = s.total(), f[kGap] = s.gap / unit, f[kLength] = s.length / unit, f[kTurn] = s.turn / unit;
        f[kUnfaced] = s.unfaced / unit, f[kPieces] = check.components, f[kLoops] = check.boundary_loops;
        f[kBad] = check.nonmanifold_edges + check.nonmanifold_vertices + check.inconsistent_edges;
        f[kCrossings] = double(mesh::self_intersections(r.composed, 0, 1)), f[kSeconds] = seconds;
        if (!out.empty()) {
          r.composed.face_quality.assign(r.face_from_b.begin(), r.face_from_b.end());
          io::write_mesh(r.composed, out);
        }
        return f;
      },
      600);
}

/// Rest, bent; pieces, loops, what is wrong, crossings; seconds.
std::vector<double> bent(const Bend& bend, cut::Cut cut, const std::string& out) {
  compose::ComposeOptions options;
  options.cut = cut;
  Progress silent;
  const Stopwatch watch;
  compose::ComposeResult r =
      std::move(compose::deform(bend.mesh, bend.fixed, bend.moving, bend.pose, 1, options, silent).front());
  const double seconds = watch.cpu();
  const mesh::MeshCheck check = mesh::check(r.composed);
  if (!out.empty()) {
    r.composed.face_quality.assign(r.face_from_b.begin(), r.face_from_b.end());
    io::write_mesh(r.composed, out);
  }
  return {double(check.components),
          double(check.boundary_loops),
          double(check.nonmanifold_edges + check.nonmanifold_vertices + check.inconsistent_edges),
          double(mesh::self_intersections(r.composed, 0, 1)),
          double(r.composed.face_count()),
          seconds};
}

void print_bends(const std::string& out, const std::string& only) {
  Table table("Bends", {"Bend", "Cut", "Pieces (input)", "Border loops (input)", "Non-manifold",
                        "Crossing pairs (input)", "Faces (input)", "Processor s"});
  for (const Bend& bend : bends()) {
    if (bend.name.find(only) == std::string::npos) continue;
    const mesh::MeshCheck was = mesh::check(bend.mesh);
    const auto beside = [](double result, double input) { return count(result) + " (" + count(input) + ")"; };
    for (const cut::Cut cut : {cut::Cut::Mesh, cut::Cut::Thesis}) {
      const char* name = cut == cut::Cut::Mesh ? "Mesh" : "Thesis";
      const Child c =
          in_child([&] { return bent(bend, cut, out.empty() ? "" : out + "/" + file_name(bend.name, name)); }, 600);
      if (!c.ended) {
        table.row({bend.name, name, "failed"});
        continue;
      }
      table.row({bend.name, name, beside(c.figures[0], was.components), beside(c.figures[1], was.boundary_loops),
                 count(c.figures[2]), beside(c.figures[3], double(mesh::self_intersections(bend.mesh))),
                 beside(c.figures[4], bend.mesh.face_count()), text(c.figures[5])});
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string out, only;
  for (int i = 1; i < argc; ++i)
    if (!std::strcmp(argv[i], "--out") && i + 1 < argc)
      out = argv[++i];
    else
      only = argv[i];
  if (!out.empty()) std::filesystem::create_directories(out);
  double logs = 0;
  int both = 0, better = 0;
  {
    Table table("Seams: J and its parts (in units of lambda S, S the smaller model's size)",
                {"Scene", "Cut", "J", "gap", "length", "turn", "unfaced", "Pieces (A, B)", "Border loops (A, B)",
                 "Non-manifold", "Crossing pairs (A, B)", "Processor s", "Memory"});
    for (const Scene& scene : seam_scenes()) {
      if (scene.name.find(only) == std::string::npos) continue;
      const mesh::MeshCheck a = mesh::check(scene.a.mesh), b = mesh::check(scene.b.mesh);
      const auto beside = [](double result, double of_a, double of_b) {
        return count(result) + " (" + count(of_a) + ", " + count(of_b) + ")";
      };
      double j[2] = {0, 0};
      for (const cut::Cut cut : {cut::Cut::Mesh, cut::Cut::Thesis}) {
        const char* name = cut == cut::Cut::Mesh ? "Mesh" : "Thesis";
        const Child c = measured(scene, cut, out.empty() ? "" : out + "/" + file_name(scene.name, name));
        if (!c.ended) {
          table.row({scene.name, name, "failed"});
          continue;
        }
        const std::vector<double>& f = c.figures;
        j[cut == cut::Cut::Thesis] = f[kJ];
        figure("seam: " + scene.name + ", J of " + name, Better::Lower, f[kJ]);
        table.row({scene.name, name, text(f[kJ]), text(f[kGap]), text(f[kLength]), text(f[kTurn]), text(f[kUnfaced]),
                   beside(f[kPieces], a.components, b.components),
                   beside(f[kLoops], a.boundary_loops, b.boundary_loops), count(f[kBad]),
                   beside(f[kCrossings], double(mesh::self_intersections(scene.a.mesh)),
                          double(mesh::self_intersections(scene.b.mesh))),
                   text(f[kSeconds]), megabytes(c.grown)});
      }
      if (j[0] > 0 && j[1] > 0) logs += std::log(j[0] / j[1]), ++both, better += j[0] <= j[1];
    }
    if (both)
      table.note("Mesh's J over Thesis', geometric mean: " + text(std::exp(logs / both)) + "; at most Thesis' on " +
                 std::to_string(better) + " of " + std::to_string(both) + " scenes.");
  }
  print_bends(out, only);
}
