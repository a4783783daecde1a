// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a small class of models, so that the demonstrations need no data.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "parts/base/error.h"
#include "parts/io/mesh_io.h"
#include "parts/io/mlp_project.h"
#include "parts/io/raster_io.h"
#include "support/busts.h"

namespace {

using namespace parts;
using namespace parts::test;
namespace fs = std::filesystem;

const char kUsage[] =
    "usage: make_busts FOLDER [COUNT] [options]\n"
    "Writes COUNT (12) busts, FOLDER/bust_00.ply with .png and so on, and\n"
    "the MeshLab project FOLDER/busts.mlp with all of them. They stand along y, face\n"
    "+z, and their heads are about 1 high.\n"
    "  --seed S            the first bust's seed (1); the next has the next one\n"
    "  --cells N           resolution (64: about 10,000 faces)\n"
    "  --hole FILE         writes one more, of a seed not in the folder, without a\n"
    "                      ball around its nose tip, and prints the hole's box\n"
    "  --crown-hole FILE   the same without the crown\n"
    "  --scar FILE         the same with a gouged nose and cheek; prints their boxes\n"
    "  --whole FILE        the same unharmed: the truth\n";

struct Arguments {
  std::string folder, hole, crown_hole, scar, whole;
  int count = 12, cells = 64;
  unsigned seed = 1;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1, position = 0; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&]() -> std::string {
      if (i + 1 >= argc) throw UserError("The option " + word + " needs a value.");
      return argv[++i];
    };
    if (word == "--seed")
      a.seed = unsigned(std::strtoul(value().c_str(), nullptr, 10));
    else if (word == "--cells")
      a.cells = std::atoi(value().c_str());
    else if (word == "--hole")
      a.hole = value();
    else if (word == "--crown-hole")
      a.crown_hole = value();
    else if (word == "--scar")
      a.scar = value();
    else if (word == "--whole")
      a.whole = value();
    else if (word[0] == '-')
      throw UserError("There is no option " + word + ".");
    else if (position++ == 0)
      a.folder = word;
    else
      a.count = std::atoi(word.c_str());
  }
  if (a.folder.empty() || a.count < 0 || a.count > 10000 || a.cells < 16 || a.cells > 400)
    throw UserError("Wrong arguments.");
  return a;
}

void write_bust(const Mesh& mesh, const cv::Mat& image, const std::string& file) {
  const std::string texture = fs::path(file).replace_extension(".png").string();
  io::write_image(image, texture);
  Mesh named = mesh;
  named.textures = {texture};
  io::write_mesh(named, file);
}

void print_box(const char* name, const Vec3& center, double radius) {
  const Vec3 r(radius, radius, radius), a = center - r, b = center + r;
  std::printf("%s: %.4f %.4f %.4f  %.4f %.4f %.4f\n", name, a[0], a[1], a[2], b[0], b[1], b[2]);
}

void write_damaged(const Arguments& a) {
  const BustShape shape = random_bust(a.seed + unsigned(a.count) + 1000);
  const Mesh mesh = bust_mesh(shape, "", a.cells);
  const cv::Mat image = bust_texture(shape, mesh);
  const BustLandmarks at = bust_landmarks(shape);
  if (!a.whole.empty()) write_bust(mesh, image, a.whole);
  if (!a.hole.empty()) {
    write_bust(without_ball(mesh, at.nose_tip, 0.16), image, a.hole);
    print_box("hole", at.nose_tip, 0.2);
  }
  if (!a.crown_hole.empty()) {
    write_bust(without_ball(mesh, at.crown, 0.3), image, a.crown_hole);
    print_box("crown", at.crown, 0.36);
  }
  if (!a.scar.empty()) {
    const Vec3 cheek = at.nose_tip + Vec3(0.2, -0.02, -0.16);
    write_bust(gouged(gouged(mesh, at.nose_tip, 0.1, 0.09, a.seed), cheek, 0.1, 0.06, a.seed + 1), image, a.scar);
    print_box("nose", at.nose_tip, 0.2);
    print_box("cheek", cheek, 0.18);
  }
}

void write_class(const Arguments& a) {
  fs::create_directories(a.folder);
  io::MlpProject project;
  for (int i = 0; i < a.count; ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "bust_%02d.ply", i);
    const BustShape shape = random_bust(a.seed + unsigned(i));
    const Mesh mesh = bust_mesh(shape, "", a.cells);
    const std::string file = (fs::path(a.folder) / name).string();
    write_bust(mesh, bust_texture(shape, mesh), file);
    project.meshes.push_back({name, file});
  }
  if (a.count > 0) io::write_mlp(project, (fs::path(a.folder) / "busts.mlp").string());
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments a = parse(argc, argv);
  write_class(a);
  write_damaged(a);
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n%s", e.what(), kUsage);
  return 1;
}
