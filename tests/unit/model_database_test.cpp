// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/model_database.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "parts/base/error.h"
#include "parts/io/mesh_io.h"
#include "parts/io/mlp_project.h"
#include "parts/mesh/topology.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace parts {
namespace {

namespace fs = std::filesystem;

class ModelDatabaseTest : public test::Folder {
 protected:
  void file(const std::string& name, const std::string& bytes) const { std::ofstream(at(name)) << bytes; }
  std::string sentence(const std::string& database) {
    try {
      io::ModelDatabase(database, progress_);
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  }

  std::vector<std::string> log_;
  Progress progress_{{}, [this](const std::string& line) { log_.push_back(line); }};
};

TEST_F(ModelDatabaseTest, ListsAFolderInNaturalOrder) {
  const Mesh m = test::box({0, 0, 0}, {1, 1, 1});
  for (const char* name : {"head_10.ply", "head_2.off", "Head_1.obj", "x.ply", "head_010.off"})
    io::write_mesh(m, at(name));
  file("notes.txt", "no model");
  fs::create_directories(at("folder.ply"));
  const io::ModelDatabase d(folder.string(), progress_);
  std::vector<std::string> names;
  for (int i = 0; i < d.size(); ++i) names.push_back(d.name(i));
  EXPECT_EQ(names, (std::vector<std::string>{"Head_1.obj", "head_2.off", "head_010.off", "head_10.ply", "x.ply"}));
  EXPECT_EQ(d.load(1).face_count(), m.face_count());
  EXPECT_TRUE(log_.empty());
}

TEST_F(ModelDatabaseTest, NaturalOrderIsAStrictOrder) {
  const std::vector<std::string> sorted{"",     "1",   "01", "2",  "10",  "a", "A",   "a1",
                                        "a01b", "a1c", "a2", "a9", "a10", "b", "b 2", "b 10"};
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    EXPECT_FALSE(io::natural_less(sorted[i], sorted[i]));
    for (std::size_t j = 0; j < sorted.size(); ++j)
      if (i != j) {
        EXPECT_NE(io::natural_less(sorted[i], sorted[j]), io::natural_less(sorted[j], sorted[i]));
      }
  }
  EXPECT_TRUE(io::natural_less("head_2", "head_10"));
  EXPECT_TRUE(io::natural_less("a99999999999999999999998", "a99999999999999999999999"));
}

TEST_F(ModelDatabaseTest, PlacesTheModelsOfAProjectByTheirMatrices) {
  fs::create_directories(at("models"));
  const Mesh box = test::box({0, 0, 0}, {1, 2, 3});
  io::write_mesh(box, at("models/a.ply"));
  io::MlpProject p;
  p.meshes.resize(3);
  for (io::MlpMesh& m : p.meshes) m.label = "box", m.file = at("models/a.ply");
  p.meshes[1].matrix.topLeftCorner<3, 3>() *= -2;  // mirrored
  p.meshes[1].matrix(0, 3) = 10;
  p.meshes[2].file = at("models/lost.ply");
  io::write_mlp(p, at("p.mlp"));
  const io::ModelDatabase d(at("p.mlp"), progress_);
  ASSERT_EQ(d.size(), 2);
  EXPECT_EQ(d.name(0), "box");
  EXPECT_EQ(d.name(1), "box (2)");
  EXPECT_EQ(d.load(0).vertices, box.vertices);
  const Mesh moved = d.load(1);
  EXPECT_TRUE(moved.bounds().isApprox(Box(Vec3(8, -4, -6), Vec3(10, 0, 0))));
  double volume = 0;
  for (int f = 0; f < moved.face_count(); ++f)
    volume += moved.corner(f, 0).dot(moved.corner(f, 1).cross(moved.corner(f, 2))) / 6;
  EXPECT_NEAR(volume, 48, 1e-9) << "outside must stay outside";
  ASSERT_EQ(log_.size(), 1u);
  EXPECT_EQ(log_[0].rfind("skipped: box (3) (", 0), 0u) << log_[0];
}

TEST_F(ModelDatabaseTest, NamesAndSkipsWhatCannotBeUsed) {
  file("broken.ply", "ply\nformat ascii 1.0\nelement vertex 5\n");
  file("empty.off", "");
  file("flat.off", "OFF\n3 1 0\n1 1 1\n1 1 1\n1 1 1\n3 0 1 2\n");
  file("huge.off", "OFF\n3 1 0\n0 0 0\n1e300 0 0\n0 1e300 0\n3 0 1 2\n");
  file("nan.off", "OFF\n3 1 0\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n");
  file("points.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n");
  file("stray.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\nnan nan nan\n3 0 1 2\n");
  const io::ModelDatabase d(folder.string(), progress_);
  ASSERT_EQ(d.size(), 7);
  for (int i = 0; i < 6; ++i) {
    EXPECT_FALSE(d.load_or_skip(i, progress_)) << d.name(i);
    ASSERT_EQ(int(log_.size()), i + 1) << d.name(i);
    EXPECT_EQ(log_[i].rfind("skipped: " + d.name(i) + " (", 0), 0u) << log_[i];
    EXPECT_THROW(d.load(i), UserError);
  }
  const auto stray = d.load_or_skip(6, progress_);
  ASSERT_TRUE(stray);
  EXPECT_EQ(mesh::check(*stray).nonfinite_vertices + mesh::check(*stray).unused_vertices, 0);
}

TEST_F(ModelDatabaseTest, AMeshFileStandsForItsFolder) {
  for (const char* name : {"a.off", "b.off"}) file(name, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const io::ModelDatabase d(at("b.off"), progress_);
  EXPECT_EQ(d.size(), 2);
  EXPECT_TRUE(std::filesystem::equivalent(d.path(), folder));
}

TEST_F(ModelDatabaseTest, AnEmptyDatabaseIsASentence) {
  EXPECT_NE(sentence(folder.string()).find("choose another folder"), std::string::npos);
  EXPECT_NE(sentence(at("none")).find("does not exist"), std::string::npos);
  EXPECT_NE(sentence(""), "");
  file("a.txt", "x");
  EXPECT_NE(sentence(at("a.txt")).find("neither a folder nor"), std::string::npos);
  io::write_mlp({}, at("p.mlp"));
  EXPECT_NE(sentence(at("p.mlp")).find("add models"), std::string::npos);
}

}  // namespace
}  // namespace parts
