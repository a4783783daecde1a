// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/search/search.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <set>

#include "parts/base/error.h"
#include "parts/io/mesh_io.h"
#include "support/busts.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace parts {
namespace {

namespace fs = std::filesystem;

struct Bust {
  Mesh mesh;
  Vec3 nose;
};

const Bust& bust(unsigned seed) {
  static std::map<unsigned, Bust> made;
  Bust& b = made[seed];
  if (b.mesh.faces.empty()) {
    const test::BustShape shape = test::random_bust(seed);
    b.mesh = test::bust_mesh(shape, "", 24);
    b.mesh.wedges.clear(), b.mesh.textures.clear();
    b.nose = test::bust_landmarks(shape).nose_tip;
  }
  return b;
}

class Search : public test::Folder {
 protected:
  void add(unsigned seed, double scale = 1) {
    Mesh m = bust(seed).mesh;
    for (Vec3& v : m.vertices) v *= scale;
    io::write_mesh(m, (folder / ("bust_" + std::to_string(seed) + ".off")).string());
  }
  std::vector<search::Candidate> find(const search::SearchQuery& query, const search::SearchOptions& options = {}) {
    const io::ModelDatabase database(folder.string(), progress_);
    return search::find_similar(query, database, options, progress_);
  }

  std::vector<std::string> log_;
  Progress progress_{{}, [this](const std::string& line) { log_.push_back(line); }};
};

/// Bust 1 without its nose, moved.
search::SearchQuery noseless(const Eigen::Affine3d& motion) {
  search::SearchQuery q;
  q.mesh = test::moved(test::without_ball(bust(1).mesh, bust(1).nose, 0.16), motion);
  const double scale = motion.linear().col(0).norm();
  q.region =
      Box(motion * bust(1).nose - Vec3::Constant(0.22 * scale), motion * bust(1).nose + Vec3::Constant(0.22 * scale));
  return q;
}

Eigen::Affine3d turned_and_scaled(double scale) {
  Eigen::Affine3d m(Eigen::Translation3d(3, -2, 5) * Eigen::AngleAxisd(0.3, Vec3(1, 2, -1).normalized()));
  m.linear() *= scale;
  return m;
}

void expect_nose_to_nose(const search::Candidate& c, unsigned seed, const Eigen::Affine3d& motion, double unit = 1) {
  const double scale = motion.linear().col(0).norm();
  EXPECT_LT((c.placement * (unit * bust(seed).nose) - motion * bust(1).nose).norm(), 0.08 * scale) << "bust " << seed;
  const Eigen::Matrix3d l = c.placement.linear();
  EXPECT_TRUE((l * l.transpose()).isApprox(std::pow(l.col(0).norm(), 2) * Eigen::Matrix3d::Identity(), 1e-6));
  EXPECT_GT(l.determinant(), 0);
  EXPECT_GE(c.score, 0);
}

TEST_F(Search, LaysNoseOnNose) {
  for (unsigned seed : {2u, 3u, 4u, 5u}) add(seed);
  const Eigen::Affine3d motion = turned_and_scaled(1.13);
  search::SearchOptions options;
  options.candidates = 4;
  const std::vector<search::Candidate> found = find(noseless(motion), options);
  ASSERT_EQ(found.size(), 4u);
  std::set<int> models;
  for (const search::Candidate& c : found) {
    expect_nose_to_nose(c, unsigned(c.model + 2), motion);
    models.insert(c.model);
  }
  EXPECT_EQ(models.size(), 4u);
  for (int i = 1; i < 4; ++i) EXPECT_LE(found[i - 1].score, found[i].score);
}

TEST_F(Search, FindsTheModelItself) {
  for (unsigned seed : {1u, 2u, 3u}) add(seed);
  const Eigen::Affine3d motion = turned_and_scaled(0.9);
  const search::Candidate c = find(noseless(motion)).at(0);
  EXPECT_EQ(c.model, 0);
  EXPECT_LT((c.placement.matrix() - motion.matrix()).norm(), 0.02);
  EXPECT_LT(c.score, 0.03);
}

TEST_F(Search, BridgesUnits) {
  add(2, 0.001);
  add(3, 1000);
  const Eigen::Affine3d motion = turned_and_scaled(1);
  for (bool scale : {true, false}) {
    search::SearchOptions options;
    options.candidates = 2;
    options.allow_scale = scale;
    for (const search::Candidate& c : find(noseless(motion), options)) {
      const double unit = c.model == 0 ? 0.001 : 1000;
      expect_nose_to_nose(c, unsigned(c.model + 2), motion, unit);
      if (!scale) {
        EXPECT_NEAR(c.placement.linear().col(0).norm() * unit, 1, 1e-9);
      }
    }
  }
}

TEST_F(Search, IgnoresDamageAndOddCoordinates) {
  for (unsigned seed : {2u, 3u}) add(seed);
  search::SearchQuery q;
  std::vector<char> damaged;
  q.mesh = test::gouged(bust(1).mesh, bust(1).nose, 0.16, 0.12, 7, &damaged);
  for (char d : damaged) q.face_weight.push_back(d ? 0 : 1);
  q.region = Box(bust(1).nose - Vec3::Constant(0.22), bust(1).nose + Vec3::Constant(0.22));
  q.mesh.vertices[q.mesh.faces[0][0]].x() = std::numeric_limits<double>::quiet_NaN();
  q.mesh.vertices.push_back(Vec3::Constant(std::numeric_limits<double>::infinity()));
  const search::Candidate c = find(q).at(0);
  expect_nose_to_nose(c, unsigned(c.model + 2), Eigen::Affine3d::Identity());
}

TEST_F(Search, IsTheSameForAnyNumberOfThreads) {
  for (unsigned seed : {2u, 3u, 4u}) add(seed);
  search::SearchOptions one, three;
  one.threads = 1, three.threads = 3;
  one.candidates = three.candidates = 3;
  const auto a = find(noseless(turned_and_scaled(1.1)), one), b = find(noseless(turned_and_scaled(1.1)), three);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].model, b[i].model);
    EXPECT_EQ(a[i].placement.matrix(), b[i].placement.matrix());
    EXPECT_EQ(a[i].score, b[i].score);
  }
}

TEST_F(Search, RemembersWhereModelsFitted) {
  for (unsigned seed : {2u, 3u, 4u}) add(seed);
  const Eigen::Affine3d motion = turned_and_scaled(1.1);
  const io::ModelDatabase database(folder.string(), progress_);
  search::SearchMemory memory;
  search::find_similar(noseless(motion), database, {}, progress_, &memory);
  EXPECT_EQ(memory.placements.size(), 3u);
  fs::remove_all(folder / ".model-cache");
  std::vector<std::string> stages;
  Progress watched([&](int, const char* stage) { return stages.push_back(stage), true; });
  const search::Candidate c = search::find_similar(noseless(motion), database, {}, watched, &memory).at(0);
  expect_nose_to_nose(c, unsigned(c.model + 2), motion);
  EXPECT_EQ(std::count(stages.begin(), stages.end(), "Comparing everywhere"), 0);
  EXPECT_FALSE(fs::exists(folder / ".model-cache"));
  // Wrong memories do not mislead.
  for (auto& [model, placement] : memory.placements) placement = Eigen::Translation3d(1, 2, 3) * placement;
  const search::Candidate again = search::find_similar(noseless(motion), database, {}, progress_, &memory).at(0);
  expect_nose_to_nose(again, unsigned(again.model + 2), motion);
}

TEST_F(Search, SaysWhatIsWrong) {
  const auto sentence = [&](const search::SearchQuery& q) -> std::string {
    try {
      find(q);
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  };
  std::ofstream(folder / "a.off") << "OFF\n";
  search::SearchQuery q = noseless(Eigen::Affine3d::Identity());
  EXPECT_NE(sentence(q).find("No model of the database can be used"), std::string::npos);
  EXPECT_EQ(std::count_if(log_.begin(), log_.end(), [](const std::string& l) { return l.rfind("skipped: ", 0) == 0; }),
            1);
  add(2);
  EXPECT_EQ(find(q).at(0).model, 1);
  q.face_weight.assign(q.mesh.faces.size(), 0);
  EXPECT_NE(sentence(q).find("No undamaged surface"), std::string::npos);
  q.face_weight.clear();
  q.region = Box(Vec3::Constant(100), Vec3::Constant(101));
  EXPECT_NE(sentence(q).find("No undamaged surface"), std::string::npos);
}

TEST_F(Search, StopsWhenCancelled) {
  add(2);
  const io::ModelDatabase database(folder.string(), progress_);
  for (int last : {0, 40, 60, 80, 90}) {
    Progress p([&](int percent, const char*) { return percent < last; });
    EXPECT_THROW(search::find_similar(noseless(Eigen::Affine3d::Identity()), database, {}, p), Cancelled) << last;
  }
}

}  // namespace
}  // namespace parts
