// SPDX-License-Identifier: GPL-3.0-or-later
// How often find_similar finds the right place, and how long it takes. Every
// member of a class in turn is the query: a part of it is removed, it is turned
// by up to 20 degrees, scaled by up to 15 % and moved; the others are the
// database. bench_search [CLASS [QUERIES]].

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>

#include "bench/fill_cases.h"
#include "bench/measure.h"
#include "parts/io/mesh_io.h"
#include "parts/io/mlp_project.h"
#include "parts/mesh/attributes.h"
#include "parts/search/search.h"
#include "support/busts.h"
#include "support/shapes.h"

using namespace parts;
using namespace parts::bench;
namespace fs = std::filesystem;

namespace {

struct Class {
  std::string name;
  std::vector<std::string> files;
  std::vector<Mesh> meshes;
  /// Per model: where the place is that is to be found.
  std::function<Vec3(int model)> place;
};

struct Task {
  std::string name;
  double radius;  ///< of the ball that is removed, as a share of the box's diagonal
  double turn = 20, scale = 0.15;
  double units = 1;      ///< the query's
  bool partial = false;  ///< only what lies within 4 radii is there
};

Vec3 center_of(const Mesh& mesh, const std::function<double(const Vec3&)>& key) {
  return *std::max_element(mesh.vertices.begin(), mesh.vertices.end(),
                           [&](const Vec3& a, const Vec3& b) { return key(a) < key(b); });
}

/// Models with the same vertices in the same order: a vertex of one, where the key is highest, is the place.
Class same_vertices(const std::string& name, std::vector<std::string> files,
                    const std::function<double(const Vec3&)>& key, std::size_t reference = 0) {
  Class c;
  c.name = name;
  c.files = std::move(files);
  for (const std::string& f : c.files) c.meshes.push_back(io::read_mesh(f));
  if (c.files.size() <= reference) return {};
  const Mesh& first = c.meshes[reference];
  const Vec3 at = center_of(first, key);
  const auto v = std::find(first.vertices.begin(), first.vertices.end(), at) - first.vertices.begin();
  std::vector<Vec3> places;
  for (const Mesh& m : c.meshes) places.push_back(m.vertices.at(std::size_t(v)));
  c.place = [places](int i) { return places[std::size_t(i)]; };
  return c;
}

Class busts(const fs::path& folder, int count) {
  Class c;
  c.name = "busts, nose";
  std::vector<Vec3> places;
  for (int i = 0; i < count; ++i) {
    const test::BustShape shape = test::random_bust(unsigned(100 + i));
    c.meshes.push_back(test::bust_mesh(shape));
    c.files.push_back((folder / ("bust_" + std::to_string(i) + ".ply")).string());
    places.push_back(test::bust_landmarks(shape).nose_tip);
    io::write_mesh(c.meshes.back(), c.files.back());
  }
  c.place = [places](int i) { return places[std::size_t(i)]; };
  return c;
}

struct Found {
  bool right = false;
  double error = 0;  ///< from place to place, as a share of the ball's radius
  Times time;
  int model = -1;
};

Found run(const Class& c, const Task& task, int i, const fs::path& folder) {
  test::Random random{unsigned(1000 + i)};
  const Mesh& whole = c.meshes[std::size_t(i)];
  const Vec3 at = c.place(i);
  const double radius = task.radius * whole.bounds().diagonal().norm();
  search::SearchQuery query;
  query.mesh = mesh::take_faces(whole, test::faces_where(whole, [&](const Vec3& p) {
                                  const double d = (p - at).norm();
                                  return d > radius && (!task.partial || d < 4 * radius);
                                }));
  const Eigen::AngleAxisd turn(random.uniform(0, task.turn) * M_PI / 180, random.direction());
  const double scale = task.units * random.uniform(1 - task.scale, 1 + task.scale);
  Eigen::Affine3d motion = Eigen::Affine3d::Identity();
  motion.linear() = scale * turn.toRotationMatrix();
  motion.translation() = random.direction() * random.uniform(0, 3) * radius * scale;
  query.mesh = test::moved(query.mesh, motion);
  const Vec3 half = Vec3::Constant(1.35 * radius * scale);
  query.region = Box(motion * at - half, motion * at + half);

  io::MlpProject project;
  std::vector<int> model_of;
  for (int m = 0; m < int(c.files.size()); ++m)
    if (m != i)
      project.meshes.push_back({fs::path(c.files[std::size_t(m)]).stem().string(), c.files[std::size_t(m)]}),
          model_of.push_back(m);
  const std::string path = (folder / ("others.mlp")).string();
  io::write_mlp(project, path);
  Progress silent;
  const io::ModelDatabase database(path, silent);
  Found found;
  std::vector<search::Candidate> candidates;
  search::SearchOptions options;
  Stopwatch watch;
  candidates = search::find_similar(query, database, options, silent);
  found.time = {watch.wall(), watch.cpu()};
  found.model = model_of[std::size_t(candidates[0].model)];
  found.error = (candidates[0].placement * c.place(found.model) - motion * at).norm() / (radius * scale);
  found.right = found.error < 0.5;
  return found;
}

void measure(const Class& c, const std::vector<Task>& tasks, int most, const fs::path& folder) {
  if (c.files.size() < 2) return;
  Table table("Right places: " + c.name, {"Query", "Right", "Median error", "90 %", "Worst", "Wall s", "Processor s"});
  for (const Task& task : tasks) {
    std::vector<double> errors, wall, cpu;
    int right = 0;
    const int n = std::min(most, int(c.files.size()));
    for (int i = 0; i < n; ++i) {
      const Found f = run(c, task, i, folder);
      right += f.right;
      errors.push_back(f.error), wall.push_back(f.time.wall), cpu.push_back(f.time.cpu);
      if (!f.right)
        table.note(task.name + ": " + fs::path(c.files[std::size_t(i)]).stem().string() + " from " +
                   fs::path(c.files[std::size_t(f.model)]).stem().string() + ", error " + text(f.error));
    }
    for (auto* v : {&errors, &wall, &cpu}) std::sort(v->begin(), v->end());
    figure("search: " + c.name + ", " + task.name + ", right", Better::Higher, double(right) / n);
    table.row({task.name, std::to_string(right) + " of " + std::to_string(n), text(errors[n / 2]),
               text(errors[n * 9 / 10]), text(errors.back()), text(wall[n / 2]), text(cpu[n / 2])});
  }
  table.note("Errors: from the place's landmark to the model's, in radii of the ball removed; right: below 0.5.");
}

/// A database of so many models: those of the class, over and over with other matrices.
std::string repeated(const Class& c, int models, const fs::path& folder) {
  io::MlpProject project;
  for (int m = 0; m < models; ++m) {
    io::MlpMesh mesh{std::to_string(m), c.files[std::size_t(m) % c.files.size()]};
    mesh.matrix(0, 3) = m;
    project.meshes.push_back(mesh);
  }
  const std::string path = (folder / (std::to_string(models) + ".mlp")).string();
  io::write_mlp(project, path);
  return path;
}

void measure_time(const Class& c, const fs::path& folder) {
  if (c.files.empty()) return;
  Table table("Time and memory: " + c.name,
              {"Models", "Search", "Wall s", "Processor s", "Peak memory", "Progress calls"});
  for (int models : {24, 125, 250, 500})
    for (const char* search : {"first", "later"}) {
      const std::string path = repeated(c, models, folder);
      const Child child = in_child(
          [&] {
            search::SearchQuery query;
            query.mesh = test::without_ball(c.meshes[0], c.place(0), 0.09 * c.meshes[0].bounds().diagonal().norm());
            const Vec3 half = Vec3::Constant(0.12 * c.meshes[0].bounds().diagonal().norm());
            query.region = Box(c.place(0) - half, c.place(0) + half);
            double calls = 0;
            Progress progress([&](int, const char*) { return ++calls > 0; });
            const Stopwatch watch;
            const io::ModelDatabase database(path, progress);
            search::find_similar(query, database, {}, progress);
            return std::vector<double>{watch.wall(), watch.cpu(), calls};
          },
          300);
      if (child.ended)
        table.row({std::to_string(models), search, text(child.figures[0]), text(child.figures[1]),
                   megabytes(child.peak), count(child.figures[2])});
      else
        table.row({std::to_string(models), search, "did not end"});
    }
  table.note("The same models over and over, each with a matrix of its own. First: with no cache of them there.");
}

}  // namespace

int main(int argc, char** argv) {
  const std::string only = argc > 1 ? argv[1] : "";
  const int most = argc > 2 ? std::atoi(argv[2]) : 1000;
  const std::string data = PARTS_DATA;
  const fs::path folder = fs::temp_directory_path() / ("bench_search_" + std::to_string(std::rand()));
  fs::create_directories(folder);
  const std::vector<Task> usual{{"turned, scaled", 0.09},
                                {"the surroundings alone", 0.09, 20, 0.15, 1, true},
                                {"in mm for m", 0.09, 20, 0.15, 1000},
                                {"turned by up to 180", 0.09, 180}};
  const auto wanted = [&](const std::string& name) { return only.empty() || only == name; };
  if (wanted("heads")) {
    measure(same_vertices("heads, nose", files_of(data + "/heads", ".obj"), [](const Vec3& p) { return p.z(); }), usual,
            most, folder);
    measure(same_vertices("heads, crown", files_of(data + "/heads", ".obj"), [](const Vec3& p) { return p.y(); }),
            {{"turned, scaled", 0.13}}, most, folder);
  }
  if (wanted("head_shapes"))
    measure(same_vertices("head_shapes, nose", files_of(data + "/head_shapes", ".ply"),
                          [](const Vec3& p) { return p.z() - 10 * std::abs(p.x()); }),
            usual, most, folder);
  if (wanted("bodies"))  // in all poses, kicking, crawling, lying; the fourth stands
    for (const auto& [place, key] : std::map<std::string, std::function<double(const Vec3&)>>{
             {"bodies, crown", [](const Vec3& p) { return p.y(); }},
             {"bodies, hand", [](const Vec3& p) { return p.x(); }},
             {"bodies, back", [](const Vec3& p) { return -(p - Vec3(0, 12, -3)).norm(); }}})
      measure(same_vertices(place, files_of(data + "/bodies", ".obj"), key, 3), {{"turned, scaled", 0.05}}, most,
              folder);
  if (wanted("hands"))
    measure(same_vertices("hands, finger", files_of(data + "/hands", ".obj"), [](const Vec3& p) { return p.y(); }),
            {{"turned, scaled", 0.08}}, most, folder);
  if (wanted("busts")) measure(busts(folder, 12), usual, most, folder);
  if (wanted("time")) {
    fs::create_directories(folder / "time");
    measure_time(same_vertices("heads", files_of(data + "/heads", ".obj"), [](const Vec3& p) { return p.z(); }),
                 folder / "time");
    fs::remove_all(folder / "time"), fs::create_directories(folder / "time");
    measure_time(
        same_vertices("head_shapes", files_of(data + "/head_shapes", ".ply"), [](const Vec3& p) { return p.z(); }),
        folder / "time");
  }
  fs::remove_all(folder);
}
