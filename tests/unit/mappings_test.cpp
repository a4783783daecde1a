// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "parts/base/error.h"
#include "parts/examples/build_mappings.h"
#include "parts/examples/examples.h"
#include "parts/examples/stored_examples.h"
#include "parts/io/class_preset.h"
#include "parts/io/mesh_io.h"
#include "parts/io/mlp_project.h"
#include "parts/io/raster_io.h"
#include "parts/render/mlp_camera.h"
#include "support/cameras.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace parts {
namespace {

namespace fs = std::filesystem;
using namespace parts::test;

bool same(const cv::Mat& a, const cv::Mat& b) {  // bit for bit but for the bits of NaN
  if (a.size() != b.size() || a.type() != b.type()) return false;
  if (a.empty() || a.type() != CV_32F) return a.empty() || cv::norm(a, b, cv::NORM_INF) == 0;
  for (int y = 0; y < a.rows; ++y)
    for (int x = 0; x < a.cols; ++x) {
      const float u = a.at<float>(y, x), v = b.at<float>(y, x);
      if (u != v && !(std::isnan(u) && std::isnan(v))) return false;
    }
  return true;
}

/// A folder with a class of painted blobs, of which one is in other units.
struct Mappings : test::Folder {
  Mappings() {
    fs::create_directories(folder / "models");
    for (int i = 0; i < 3; ++i) {
      Mesh blob = noisy_sphere({0, 0, 0}, 1, 3, 0.3, unsigned(i + 1));
      for (Vec3& v : blob.vertices) v = Vec3(v.x(), 1.4 * v.y(), v.z()) * (i == 2 ? 1000 : 1 + 0.1 * i);
      for (const Vec3& v : blob.vertices)
        blob.vertex_color.push_back({std::uint8_t(128 + 100 * std::sin(5 * v.x())), std::uint8_t(60 * i), 90, 255});
      io::write_mesh(blob, (folder / "models" / ("blob_" + std::to_string(i) + ".ply")).string());
    }
    options.width = 60, options.height = 80;
  }
  io::ModelDatabase models() { return io::ModelDatabase(at("models"), progress); }
  examples::MappingsReport build(const std::string& output) {
    return examples::build_mappings(models(), views, output, options, progress);
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      names.insert(fs::relative(entry.path(), folder).string());
    return names;
  }

  Progress progress;
  examples::ExampleOptions options;
  std::vector<render::View> views = {{0, 0}, {30, -15}};
};

TEST(MlpCamera, ProjectsAsMeshLabDoes) {
  // vcglib: q = R (p - eye), q.z negated; perspective: q * focal / q.z; then pixels = q / size + centre, from below.
  const Eigen::Matrix3d rotation = render::view_rotation({30, 20}, {0, 1, 0}, {0, 0, 1});
  for (const bool pinhole : {false, true}) {
    const Box box(Vec3(-1, -2, -1), Vec3(1, 2, 3));
    render::Camera camera =
        pinhole ? pinhole_camera(rotation, box, 150, 200, 300) : render::orthographic_camera(rotation, box, 150, 200);
    camera.center += Eigen::Vector2d(3, -7);
    const io::MlpCamera mlp = render::to_mlp(camera, 5);
    for (const Vec3& p : {Vec3(0.3, -0.7, 0.2), Vec3(-1, 2, 1)}) {
      const Vec3 q = mlp.rotation * (p + mlp.translation);
      Eigen::Vector2d local = q.head<2>();
      if (mlp.type == 0) local *= mlp.focal_mm / -q.z();
      const Eigen::Vector2d px = local.cwiseQuotient(mlp.pixel_mm) + mlp.center_px;
      const Vec3 ours = camera.project(p);
      EXPECT_NEAR(px.x(), ours.x(), 1e-9);
      EXPECT_NEAR(mlp.viewport_px.y() - px.y(), ours.y(), 1e-9);
      EXPECT_LT((render::from_mlp(mlp, "r").project(p) - ours).norm(), 1e-9);
    }
    EXPECT_EQ(mlp.type, pinhole ? 0 : 1);
  }
}

TEST(MlpCamera, WhatIsNoCamera) {
  EXPECT_NE(sentence([] { render::from_mlp({}, "a"); }).find("\"a\" has no camera"), std::string::npos);
  render::Camera camera;
  camera.width = 4, camera.height = 3;
  io::MlpCamera mlp = render::to_mlp(camera, 1);
  mlp.viewport_px.setZero();
  EXPECT_NE(sentence([&] { render::from_mlp(mlp, "a"); }).find("viewport"), std::string::npos);
  mlp = render::to_mlp(camera, 1);
  mlp.pixel_mm.x() = 0;
  EXPECT_NE(sentence([&] { render::from_mlp(mlp, "a"); }).find("pixels"), std::string::npos);
  mlp = render::to_mlp(camera, 1);
  mlp.type = 0, mlp.focal_mm = 0;
  EXPECT_NE(sentence([&] { render::from_mlp(mlp, "a"); }).find("focal"), std::string::npos);
  mlp = render::to_mlp(camera, 1);
  mlp.rotation.setZero();
  EXPECT_NE(sentence([&] { render::from_mlp(mlp, "a"); }).find("rotation"), std::string::npos);
}

TEST(Views, AnglesBetween) {
  EXPECT_NEAR(render::angle_between({10, 0}, {40, 0}), 30, 1e-9);
  EXPECT_NEAR(render::angle_between({0, -20}, {0, 15}), 35, 1e-9);
  EXPECT_NEAR(render::angle_between({0, 90}, {123, 90}), 0, 1e-6);
  EXPECT_NEAR(render::angle_between({170, 0}, {-170, 0}), 20, 1e-9);
}

TEST_F(Mappings, ModelsAreFramedAlike) {
  const auto source = examples::render_examples(models(), views, options, progress);
  ASSERT_EQ(source->size(), 3);
  EXPECT_EQ(source->image_size(), cv::Size(60, 80));
  EXPECT_TRUE(source->views(0).empty());
  double area[3], middle[3], scale[3];
  for (int i = 0; i < 3; ++i) {
    const examples::Example e = source->get(i, {0, 0});
    EXPECT_EQ(e.object, source->name(i));
    EXPECT_TRUE(same(e.mask, io::depth_mask(e.depth)));
    EXPECT_TRUE(same(e.mask, io::depth_mask(e.back_depth)));
    area[i] = cv::countNonZero(e.mask);
    scale[i] = e.pixels_per_unit();
    middle[i] = 0.5 * (cv::mean(e.depth, e.mask)[0] + cv::mean(e.back_depth, e.mask)[0]) * scale[i];
    for (const render::View& v :
         {render::View{35, 0}, render::View{-35, -25}, render::View{65, 10}}) {  // nothing is cut off on the way
      const cv::Mat mask = source->get(i, v).mask;
      const int rim = cv::countNonZero(mask.row(0)) + cv::countNonZero(mask.row(79)) + cv::countNonZero(mask.col(0)) +
                      cv::countNonZero(mask.col(59));
      EXPECT_EQ(rim, 0);
    }
  }
  EXPECT_EQ(scale[0], scale[1]) << "sizes that differ a little are kept";
  EXPECT_LT(area[0], area[1]);
  EXPECT_NEAR(scale[2], scale[0] / 1000, 0.4 * scale[0] / 1000) << "other units";
  EXPECT_NEAR(area[2], area[0], 0.35 * area[0]);
  for (int i = 1; i < 3; ++i) EXPECT_NEAR(middle[i], middle[0], 2.5) << "pixels";
}

TEST_F(Mappings, AStoredDatabaseGivesWhatWasRendered) {
  const examples::MappingsReport report = build(at("db/class.mlp"));
  EXPECT_EQ(report.objects, 3);
  EXPECT_EQ(report.examples, 6);
  EXPECT_GT(report.megabytes, 0.1);
  const auto stored = examples::open_examples(at("db/class.mlp"), views, options, progress);
  ASSERT_EQ(stored->size(), 3);
  EXPECT_EQ(stored->image_size(), cv::Size(60, 80));
  EXPECT_EQ(*stored->preset().up, Vec3(0, 1, 0));
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(stored->views(i).size(), 2u);
    EXPECT_EQ(stored->views(i)[1].yaw, 30);
    EXPECT_EQ(stored->views(i)[1].pitch, -15);
    const examples::Example a = stored->get(i, {25, 0}), again = stored->get(i, {25, 0});
    EXPECT_EQ(a.view.yaw, 30) << "the nearest view";
    EXPECT_TRUE(same(a.depth, again.depth));
    EXPECT_TRUE(same(a.mask, io::depth_mask(a.depth)));
    EXPECT_EQ(a.object, "blob_" + std::to_string(i) + ".ply");
    // Points seen through the stored camera lie on the model.
    const Mesh mesh = models().load(i);
    const Vec3 p = a.camera.unproject(30.5, 40.5, a.depth.at<float>(40, 30));
    double nearest = 1e300;
    for (const Vec3& v : mesh.vertices) nearest = std::min(nearest, (v - p).norm());
    EXPECT_LT(nearest, 0.06 * mesh.bounds().diagonal().norm());
    EXPECT_GT(a.back_depth.at<float>(40, 30), a.depth.at<float>(40, 30));
  }
  // The same rendering, if framed for the same views.
  const io::MlpProject project = io::read_mlp(at("db/class.mlp"));
  ASSERT_EQ(project.rasters.size(), 6u);
  ASSERT_EQ(project.meshes.size(), 1u) << "for MeshLab to show";
  const Mesh surface = io::read_mesh(project.meshes[0].file);
  EXPECT_TRUE(fs::equivalent(surface.textures.at(0), project.rasters[0].planes[0].file));
  for (const io::MlpRaster& r : project.rasters) {
    ASSERT_EQ(r.planes.size(), 4u);
    EXPECT_EQ(r.planes[0].semantic, io::plane::kColor) << "MeshLab shows the first plane";
    EXPECT_EQ(r.camera.type, 1);
  }
}

TEST_F(Mappings, WithoutBackSide) {
  options.back = false;
  build(at("class.mlp"));
  const auto stored = examples::open_mapping_database(at("class.mlp"), progress);
  EXPECT_TRUE(stored->get(0, {0, 0}).back_depth.empty());
  EXPECT_EQ(io::read_mlp(at("class.mlp")).rasters[0].planes.size(), 3u);
}

TEST_F(Mappings, BuildingAgainReplaces) {
  build(at("class.mlp"));
  const std::set<std::string> first = files();
  std::ofstream(folder / "class_mappings" / "mine.txt") << "of the user";
  views = {{10, 0}};
  build(at("class.mlp"));
  const auto stored = examples::open_mapping_database(at("class.mlp"), progress);
  EXPECT_EQ(stored->views(0).size(), 1u);
  int images = 0;
  for (const std::string& name : files()) images += name.find("class_mappings/0") == 0;
  EXPECT_EQ(images, 3 * 4 + 1) << "files of the old views are gone";
  EXPECT_TRUE(fs::exists(folder / "class_mappings" / "manifest.json"));
  EXPECT_TRUE(fs::exists(folder / "class_mappings" / "mine.txt"));
}

TEST_F(Mappings, ModelsInTheFolderOfTheDatabaseStay) {
  fs::create_directories(folder / "class_mappings");
  for (const char* name : {"m0.ply", "m1.ply"})
    fs::copy_file(folder / "models/blob_0.ply", folder / "class_mappings" / name);
  const auto run = [&] {
    examples::build_mappings(io::ModelDatabase(at("class_mappings"), progress), views, at("class.mlp"), options,
                             progress);
  };
  build(at("class.mlp"));
  io::MlpProject project = io::read_mlp(at("class.mlp"));  // as MeshLab saves it with the models open
  for (const char* name : {"class_mappings/m0.ply", "class_mappings/m1.ply"})
    project.meshes.push_back({name, at(name)});
  io::write_mlp(project, at("class.mlp"));
  build(at("class.mlp"));
  EXPECT_TRUE(fs::exists(at("class_mappings/m0.ply")));
  EXPECT_TRUE(fs::exists(at("class_mappings/m1.ply")));
  // And where they, and the surface of the database itself, are the models.
  const std::string surface = io::read_mlp(at("class.mlp")).meshes.at(0).file;
  views = {{10, 0}};
  run();
  EXPECT_TRUE(fs::exists(surface)) << "it was an input";
  EXPECT_TRUE(fs::exists(at("class_mappings/m0.ply")));
  EXPECT_TRUE(fs::exists(at("class_mappings/m1.ply")));
}

TEST_F(Mappings, AUsersFileOfANewFilesNameIsNotReplaced) {
  fs::create_directories(folder / "class_mappings");
  const fs::path mine = folder / "class_mappings/000_blob_0_0_0_depth.tif";
  std::ofstream(mine) << "mine";
  const std::set<std::string> before = files();
  EXPECT_NE(sentence([&] { build(at("class.mlp")); }).find("would be replaced"), std::string::npos);
  EXPECT_EQ(files(), before);
}

TEST_F(Mappings, HandSetWeightsSurviveARebuild) {
  std::ofstream(folder / "models/class.json")
      << R"({ "reconstruct_depth": { "WeightDepth": 3, "WeightPosition": 7 } })";
  build(at("class.mlp"));
  EXPECT_EQ(*io::read_class_preset(at("class.mlp")).number("reconstruct_depth", "WeightPosition"), 7);
  std::ofstream(folder / "class.class.json")
      << R"({ "Up": [0, 1, 0], "note": ["by hand"], "reconstruct_depth": { "WeightPosition": 42 } })";
  build(at("class.mlp"));
  const io::ClassPreset preset = io::read_class_preset(at("class.mlp"));
  EXPECT_EQ(*preset.number("reconstruct_depth", "WeightPosition"), 42);
  EXPECT_EQ(*preset.number("reconstruct_depth", "WeightDepth"), 3);
  std::ifstream file(at("class.class.json"));
  EXPECT_NE(std::string(std::istreambuf_iterator<char>(file), {}).find("by hand"), std::string::npos);
}

TEST_F(Mappings, AFailureLeavesTheOldDatabase) {
  build(at("class.mlp"));
  const std::set<std::string> before = files();
  const auto time = fs::last_write_time(at("class.mlp"));
  std::ofstream(folder / "class.class.json") << "[";  // found late
  views = {{10, 0}};
  EXPECT_NE(sentence([&] { build(at("class.mlp")); }).find("class preset"), std::string::npos);
  EXPECT_EQ(files(), before);
  EXPECT_EQ(fs::last_write_time(at("class.mlp")), time);
}

TEST_F(Mappings, ADiskThatIsFullAtAnyMoment) {
  options.back = false;
  int failed = 0, built = 0;
  for (int kilobytes = 200; kilobytes <= 1000; kilobytes += 40) {
    fs::create_directories(folder / "tiny");
    const std::string size = "size=" + std::to_string(kilobytes) + "k";
    if (::mount("tmpfs", at("tiny").c_str(), "tmpfs", 0, size.c_str()) != 0) GTEST_SKIP() << "needs root";
    bool whole = false;
    try {
      build(at("tiny/class.mlp"));
      whole = io::read_mlp(at("tiny/class.mlp")).meshes.size() == 1;
      ++built;
    } catch (const UserError& e) {
      whole = fs::is_empty(folder / "tiny");
      ++failed;
    }
    ::umount(at("tiny").c_str());
    EXPECT_TRUE(whole) << kilobytes;
  }
  EXPECT_GT(failed, 0);
  EXPECT_GT(built, 0);
}

TEST_F(Mappings, PresetsThatBreakAParser) {
  const std::string deep(200000, '['), pairs = [] {
    std::string s;
    for (int i = 0; i < 50000; ++i) s += "{\"a\":";
    return s;
  }();
  for (const std::string& text :
       {std::string("<?xml version="), "{\"a\":" + deep, deep, pairs, std::string("{\"a\": 1e999}"), std::string("[1]"),
        std::string(), "{\"a\":" + std::string(40, '[') + std::string(40, ']') + "}"}) {
    EXPECT_FALSE(io::parse_class_preset(text)) << text.substr(0, 30);
    keep_for_corpus("json", text);
    std::ofstream(folder / "models/class.json") << text;
    EXPECT_NE(sentence([&] { io::read_class_preset(at("models")); }).find("The class preset"), std::string::npos);
  }
  EXPECT_EQ(
      io::parse_class_preset(R"({ "f": { "A": true, "B": 1.5, "C": "x", "D": [1], "E": null } })")->values.at("f"),
      (std::map<std::string, std::string>{{"A", "1"}, {"B", "1.5"}, {"C", "x"}}));
}

TEST_F(Mappings, CancellingLeavesNothing) {
  const std::set<std::string> before = files();
  int calls = 0;
  Progress cancelling([&](int percent, const char*) { return ++calls < 6 || percent < 40; });
  EXPECT_THROW(examples::build_mappings(models(), views, at("class.mlp"), options, cancelling), Cancelled);
  EXPECT_EQ(files(), before);
}

TEST_F(Mappings, OutputsThatWouldDoHarm) {
  EXPECT_NE(sentence([&] { build(""); }).find("No output"), std::string::npos);
  EXPECT_NE(sentence([&] { build(at("class.txt")); }).find(".mlp"), std::string::npos);
  EXPECT_NE(sentence([&] { build(at("models")); }).find(".mlp"), std::string::npos);
  io::MlpProject project;
  project.meshes.push_back({"blob", at("models/blob_0.ply"), Eigen::Matrix4d::Identity()});
  io::write_mlp(project, at("models.mlp"));
  EXPECT_NE(sentence([&] { build(at("models.mlp")); }).find("another name"), std::string::npos);
  const io::ModelDatabase itself(at("models.mlp"), progress);
  EXPECT_NE(sentence([&] {
              examples::build_mappings(itself, views, at("models.mlp"), options, progress);
            }).find("is the model"),
            std::string::npos);
  std::ofstream(at("file")) << "x";
  EXPECT_NE(sentence([&] { build(at("file/class.mlp")); }).find("cannot be made"), std::string::npos);
  options.width = 100000;
  EXPECT_NE(sentence([&] { build(at("class.mlp")); }).find("8192"), std::string::npos);
}

TEST_F(Mappings, DamagedDatabasesAreNamed) {
  build(at("class.mlp"));
  const io::MlpProject whole = io::read_mlp(at("class.mlp"));
  const std::string depth = whole.rasters[1].file_of(io::plane::kDepth);
  const auto opened = [&] { return examples::open_mapping_database(at("class.mlp"), progress); };

  fs::rename(depth, depth + ".away");
  EXPECT_NE(sentence([&] { opened(); }).find(fs::path(depth).filename().string() + "\" of the database"),
            std::string::npos);
  io::write_depth(cv::Mat(5, 5, CV_32F, cv::Scalar(1)), depth);
  EXPECT_NE(sentence([&] { opened(); }).find("5 x 5 pixels"), std::string::npos);
  io::write_depth(cv::Mat(80, 60, CV_32F, cv::Scalar(NAN)), depth);
  EXPECT_NE(sentence([&] { opened()->get(0, {30, -15}); }).find("background everywhere"), std::string::npos);
  fs::rename(depth + ".away", depth);

  io::MlpProject broken = whole;
  broken.rasters[0].camera.given = false;
  for (io::MlpRaster& r : broken.rasters)
    for (io::MlpPlane& p : r.planes)
      if (p.semantic == io::plane::kDepth) p.semantic = io::plane::kColor;
  io::write_mlp(broken, at("class.mlp"));
  EXPECT_NE(sentence([&] { opened(); }).find("no raster with a depth plane"), std::string::npos);
  io::write_mlp({}, at("class.mlp"));
  EXPECT_NE(
      sentence([&] { examples::open_examples(at("class.mlp"), views, options, progress); }).find("neither models nor"),
      std::string::npos);
}

TEST_F(Mappings, AUsersOwnDatabase) {
  // No mask, no back, labels without views, another order: what can be made in MeshLab itself.
  const auto rendered = examples::render_examples(models(), views, options, progress);
  const examples::Example e = rendered->get(1, {-40, 20});
  io::write_image(e.image, at("photo.png"));
  io::write_depth(e.depth, at("photo.pfm"));
  io::MlpProject project;
  project.rasters.resize(2);
  project.rasters[0].label = "a photo without depth";
  project.rasters[1].label = "a, b";
  project.rasters[1].camera = render::to_mlp(e.camera, 1);
  project.rasters[1].planes = {{io::plane::kDepth, at("photo.pfm")}, {io::plane::kColor, at("photo.png")}};
  io::write_mlp(project, at("own.mlp"));
  std::vector<std::string> log;
  Progress logging({}, [&](const std::string& line) { log.push_back(line); });
  const auto source = examples::open_examples(at("own.mlp"), views, options, logging);
  ASSERT_EQ(source->size(), 1);
  EXPECT_EQ(source->name(0), "a, b");
  EXPECT_NEAR(source->views(0)[0].yaw, -40, 1e-6);
  EXPECT_NEAR(source->views(0)[0].pitch, 20, 1e-6);
  EXPECT_TRUE(same(source->get(0, {}).depth, e.depth));
  EXPECT_TRUE(same(source->get(0, {}).image, e.image));
  ASSERT_EQ(log.size(), 1u);
  EXPECT_EQ(log[0], "skipped: a photo without depth (no depth plane)");
}

TEST_F(Mappings, ModelsThatCannotBeReadAreLeftOut) {
  std::ofstream(folder / "models" / "broken.obj") << "no mesh";
  std::vector<std::string> log;
  Progress logging({}, [&](const std::string& line) { log.push_back(line); });
  EXPECT_EQ(examples::render_examples(models(), views, options, logging)->size(), 3);
  EXPECT_NE(log.at(0).find("skipped: broken.obj"), std::string::npos);
  for (const auto& file : fs::directory_iterator(folder / "models"))
    if (file.path().extension() == ".ply") fs::remove(file.path());
  EXPECT_NE(sentence([&] { examples::render_examples(models(), views, options, progress); }).find("can be used"),
            std::string::npos);
}

TEST_F(Mappings, PresetsOfAClass) {
  io::ClassPreset preset;
  preset.up = Vec3(0, 0, 1);
  preset.front = Vec3(0, -1, 0);
  preset.values["reconstruct_depth"] = {{"PatchSizes", "5,7"}, {"WeightPosition", "12.5"}, {"Examples", "8"}};
  io::write_class_preset(preset, at("models"));
  EXPECT_TRUE(fs::exists(folder / "models" / "class.json"));
  const io::ClassPreset back = io::read_class_preset(at("models"));
  EXPECT_EQ(*back.up, *preset.up);
  EXPECT_EQ(*back.text("reconstruct_depth", "PatchSizes"), "5,7");
  EXPECT_EQ(*back.number("reconstruct_depth", "WeightPosition"), 12.5);
  EXPECT_EQ(*back.number("reconstruct_depth", "Examples"), 8);
  EXPECT_FALSE(back.number("reconstruct_depth", "WeightDepth"));
  EXPECT_FALSE(back.number("colorize_depth", "Examples"));
  EXPECT_EQ(examples::render_examples(models(), views, options, progress)->preset().values, preset.values);

  EXPECT_EQ(io::class_preset_path("x/heads.mlp"), "x/heads.class.json");
  EXPECT_FALSE(io::read_class_preset(at("none.mlp")).up);
  build(at("class.mlp"));
  EXPECT_EQ(examples::open_mapping_database(at("class.mlp"), progress)->preset().values, preset.values)
      << "it goes along";

  std::ofstream(folder / "models" / "class.json")
      << R"({ "Up": [0, 1], "Front": "x", "reconstruct_depth": { "A": 3 } })";
  EXPECT_FALSE(io::read_class_preset(at("models")).up);
  EXPECT_EQ(*io::read_class_preset(at("models")).number("reconstruct_depth", "A"), 3);
  for (const char* text : {"{ \"Up\": [0, 1", "words", "", "[1, 2]"}) {
    std::ofstream(folder / "models" / "class.json") << text;
    EXPECT_NE(sentence([&] { io::read_class_preset(at("models")); }).find("JSON"), std::string::npos) << text;
  }
}

TEST_F(Mappings, TheSameForAnyNumberOfThreads) {
  options.threads = 1;
  const examples::Example one = examples::render_examples(models(), views, options, progress)->get(0, {20, 10});
  options.threads = 3;
  const examples::Example three = examples::render_examples(models(), views, options, progress)->get(0, {20, 10});
  EXPECT_TRUE(same(one.image, three.image));
  EXPECT_TRUE(same(one.depth, three.depth));
}

}  // namespace
}  // namespace parts
