// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/synthesis/synthesis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "parts/synthesis/level.h"
#include "parts/synthesis/pyramid.h"

namespace parts::test {
namespace {

/// A member of a class of discs with five bumps, each somewhere near its place:
/// plane 0 is how it looks lit from the side, plane 1 its height.
synthesis::PatchImage bumps(unsigned seed, int width = 72, int height = 64) {
  std::mt19937 engine(seed);
  const auto uniform = [&](double low, double high) { return low + (high - low) * double(engine()) / 4294967296.0; };
  struct Bump {
    double x, y, size, height;
  };
  std::vector<Bump> list;
  const double places[5][2] = {{-9, -8}, {9, -8}, {0, 1}, {-6, 12}, {6, 12}};
  for (const auto& p : places)
    list.push_back({p[0] + uniform(-4, 4), p[1] + uniform(-4, 4), uniform(4, 8), uniform(2, 6)});
  const double radius = uniform(22, 26);
  synthesis::PatchImage image;
  image.planes = {cv::Mat::zeros(height, width, CV_32F), cv::Mat::zeros(height, width, CV_32F)};
  image.mask = cv::Mat::zeros(height, width, CV_8U);
  const auto at = [&](double x, double y) {
    double z = -0.01 * (x * x + y * y);
    for (const Bump& b : list)
      z += b.height * std::exp(-((x - b.x) * (x - b.x) + (y - b.y) * (y - b.y)) / (b.size * b.size));
    return z;
  };
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const double x = i - width / 2, y = j - height / 2;
      if (x * x + y * y > radius * radius) continue;
      image.mask.at<uchar>(j, i) = 255;
      image.planes[1].at<float>(j, i) = float(at(x, y));
      image.planes[0].at<float>(j, i) = float(at(x + 1, y) - at(x - 1, y) + 0.5 * (at(x, y + 1) - at(x, y - 1)));
    }
  return image;
}

synthesis::PatchImage without_depth(synthesis::PatchImage image) {
  image.planes[1] = cv::Mat();
  return image;
}

std::vector<synthesis::PatchImage> examples(int count, unsigned first = 1) {
  std::vector<synthesis::PatchImage> list;
  for (int i = 0; i < count; ++i) list.push_back(bumps(first + i));
  return list;
}

synthesis::SynthesisOptions depth_options() {
  synthesis::SynthesisOptions o;
  o.channels = {{0, 1, false, true}, {0, 0.5, true, false}, {1, 1, false, false}};
  o.synthesized = {1};
  return o;
}

double error(const cv::Mat& a, const cv::Mat& b, const cv::Mat& mask) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(a - b, mean, deviation, mask);
  return deviation[0];
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

synthesis::SynthesisResult run(const synthesis::PatchImage& query, const std::vector<synthesis::PatchImage>& list,
                               const synthesis::SynthesisOptions& options,
                               const synthesis::ExampleUpdate& update = {}) {
  Progress progress;
  return synthesis::synthesize(query, list, options, update, progress);
}

TEST(Synthesis, FindsWhatIsInTheDatabase) {
  std::vector<synthesis::PatchImage> list = examples(4);
  const synthesis::PatchImage query = without_depth(list[2]);
  const synthesis::SynthesisResult r = run(query, list, depth_options());
  cv::Scalar mean, deviation;
  cv::meanStdDev(list[2].planes[1], mean, deviation, query.mask);
  EXPECT_LT(error(r.planes[0], list[2].planes[1], query.mask), 0.02 * deviation[0]);
  EXPECT_GT(r.used[2], long(0.95 * cv::countNonZero(query.mask)));
  EXPECT_LT(cv::mean(r.distance, query.mask)[0], 0.05);
}

TEST(Synthesis, BeatsTheMeanAndEachExample) {
  const std::vector<synthesis::PatchImage> list = examples(16);
  double ours = 0, means = 0, nearests = 0;
  for (unsigned seed = 100; seed < 106; ++seed) {
    const synthesis::PatchImage query = bumps(seed);
    const synthesis::SynthesisResult r = run(without_depth(query), list, depth_options());
    cv::Mat mean = cv::Mat::zeros(query.mask.size(), CV_32F);
    double nearest = 1e30;  // knowing the truth
    for (const synthesis::PatchImage& e : list) {
      const cv::Mat depth = synthesis::extend(e.planes[1], e.mask);
      mean += depth / double(list.size());
      nearest = std::min(nearest, error(depth, query.planes[1], query.mask));
    }
    ours += error(r.planes[0], query.planes[1], query.mask);
    means += error(mean, query.planes[1], query.mask);
    nearests += nearest;
  }
  EXPECT_LT(ours, 0.9 * means);
  EXPECT_LT(ours, 0.9 * nearests);
}

TEST(Synthesis, TheObjectiveNeverFalls) {
  synthesis::SynthesisOptions o = depth_options();
  o.tolerance = 0;
  const synthesis::ExampleUpdate swap = [&](const synthesis::SynthesisState& state) {
    synthesis::ExampleChange change;
    change.drop = {int(std::min_element(state.used.begin(), state.used.end()) - state.used.begin())};
    change.add = {bumps(50 + unsigned(state.level))};
    return change;
  };
  for (const synthesis::ExampleUpdate& update : {synthesis::ExampleUpdate(), swap}) {
    const synthesis::SynthesisResult r = run(without_depth(bumps(9)), examples(6, 20), o, update);
    ASSERT_EQ(r.objective.size(), o.patch_sizes.size());
    for (const std::vector<double>& level : r.objective) {
      ASSERT_GE(level.size(), 2u);
      for (size_t i = 1; i < level.size(); ++i) EXPECT_GE(level[i], level[i - 1] - 1e-6);
      EXPECT_GT(level.back(), level.front());
    }
  }
}

TEST(Synthesis, ThreadsDoNotMatter) {
  const synthesis::PatchImage query = without_depth(bumps(7, 111, 87));
  synthesis::SynthesisOptions o = depth_options();
  o.threads = 1;
  const synthesis::SynthesisResult one = run(query, examples(5, 30), o);
  for (int threads : {2, 3, 8}) {
    o.threads = threads;
    const synthesis::SynthesisResult r = run(query, examples(5, 30), o);
    EXPECT_TRUE(same(r.planes[0], one.planes[0]));
    EXPECT_TRUE(same(r.example, one.example));
    EXPECT_TRUE(same(r.distance, one.distance));
    EXPECT_EQ(r.objective, one.objective);
  }
}

TEST(Synthesis, NearlyAsGoodAsExactSearch) {
  // One level without iterations, so that both search for the same windows.
  synthesis::SynthesisOptions o = depth_options();
  o.patch_sizes = {7};
  o.longest_coarsest = 0;
  o.max_iterations = 1;
  for (unsigned seed : {40u, 41u}) {
    const synthesis::PatchImage query = bumps(seed);  // its depth known: both channels are compared
    o.synthesized = {};
    const synthesis::SynthesisResult fast = run(query, examples(6, 60), o);
    o.exact_search = true;
    const synthesis::SynthesisResult exact = run(query, examples(6, 60), o);
    o.exact_search = false;
    double a = 0, b = 0;
    for (int y = 0; y < query.mask.rows; ++y)
      for (int x = 0; x < query.mask.cols; ++x) {
        const double f = fast.distance.at<float>(y, x), e = exact.distance.at<float>(y, x);
        EXPECT_GE(f, e - 1e-5);
        a += f * f, b += e * e;
      }
    EXPECT_LE(a / b, 1.06);
  }
}

TEST(Synthesis, SourcesAreWhereTheySayTheyAre) {
  const std::vector<synthesis::PatchImage> list = examples(5, 70);
  const synthesis::PatchImage query = without_depth(bumps(8));
  const synthesis::SynthesisResult r = run(query, list, depth_options());
  std::vector<long> used(list.size(), 0);
  for (int y = 0; y < query.mask.rows; ++y)
    for (int x = 0; x < query.mask.cols; ++x) {
      const int e = r.example.at<int>(y, x);
      ASSERT_EQ(e >= 0, query.mask.at<uchar>(y, x) != 0);
      if (e < 0) continue;
      ++used[e];
      const cv::Vec2i p = r.source.at<cv::Vec2i>(y, x);
      ASSERT_LT(e, int(list.size()));
      EXPECT_NE(list[e].mask.at<uchar>(p[1], p[0]), 0);
    }
  EXPECT_EQ(used, r.used);
}

TEST(Synthesis, DroppedExamplesAreSearchedNoMoreAndNewOnesAre) {
  std::vector<synthesis::PatchImage> list = examples(3, 80);
  const synthesis::PatchImage truth = bumps(200);
  const synthesis::ExampleUpdate update = [&](const synthesis::SynthesisState& state) {
    synthesis::ExampleChange change;
    if (state.level == state.levels - 1) change = {{0, 1}, {truth}};
    return change;
  };
  const synthesis::SynthesisResult r = run(without_depth(truth), list, depth_options(), update);
  EXPECT_EQ(r.active, (std::vector<char>{0, 0, 1, 1}));
  EXPECT_GT(r.used[3], long(0.9 * cv::countNonZero(truth.mask)));
}

TEST(Synthesis, ScalesOfPlanesDoNotMatter) {
  std::vector<synthesis::PatchImage> list = examples(4, 90);
  synthesis::PatchImage query = without_depth(bumps(17));
  const synthesis::SynthesisResult plain = run(query, list, depth_options());
  for (synthesis::PatchImage& e : list) e.planes[0] *= 64, e.planes[1] *= 0.25;
  query.planes[0] *= 64;
  const synthesis::SynthesisResult scaled = run(query, list, depth_options());
  EXPECT_LT(error(plain.planes[0], scaled.planes[0] * 4, query.mask), 1e-3);
}

TEST(Synthesis, LightAndContrastDoNotMatterToNormalizedChannels) {
  synthesis::SynthesisOptions o = depth_options();
  o.channels[1].weight = 0;
  const std::vector<synthesis::PatchImage> list = examples(6, 120);
  synthesis::PatchImage query = without_depth(bumps(33));
  const synthesis::SynthesisResult plain = run(query, list, o);
  query.planes[0] = query.planes[0] * 3 + 5;
  const synthesis::SynthesisResult bright = run(query, list, o);
  cv::Scalar mean, deviation;
  cv::meanStdDev(plain.planes[0], mean, deviation, query.mask);
  EXPECT_LT(error(plain.planes[0], bright.planes[0], query.mask), 0.1 * deviation[0]);
}

TEST(Synthesis, LargerImagesGetMoreLevels) {
  const synthesis::PatchImage query = without_depth(bumps(5, 300, 310));
  const synthesis::SynthesisResult r = run(query, {bumps(6, 300, 310)}, depth_options());
  EXPECT_EQ(r.objective.size(), 4u);
}

TEST(Synthesis, SaysWhatIsWrong) {
  const synthesis::PatchImage query = without_depth(bumps(1));
  const std::vector<synthesis::PatchImage> list = examples(2);
  EXPECT_THROW(run(query, {}, depth_options()), UserError);
  synthesis::SynthesisOptions o = depth_options();
  o.patch_sizes = {5, 8};
  EXPECT_THROW(run(query, list, o), UserError);
  o.patch_sizes = {31, 31, 31};
  EXPECT_THROW(run(query, list, o), UserError);
  o.patch_sizes = {5, 33};
  EXPECT_THROW(run(query, list, o), UserError);
  o.patch_sizes = {};
  EXPECT_THROW(run(query, list, o), UserError);
  synthesis::PatchImage empty = query;
  empty.mask = cv::Mat::zeros(query.mask.size(), CV_8U);
  EXPECT_THROW(run(empty, list, depth_options()), UserError);
  std::vector<synthesis::PatchImage> mixed = list;
  mixed[1].planes[1] = mixed[1].planes[1].rowRange(0, 20).clone();
  EXPECT_THROW(run(query, mixed, depth_options()), UserError);
}

TEST(Synthesis, ChannelsAreCheckedAtTheDoor) {
  const synthesis::PatchImage query = without_depth(bumps(1));
  const std::vector<synthesis::PatchImage> list = examples(2);
  synthesis::SynthesisOptions o = depth_options();
  while (int(o.channels.size()) < synthesis::most_channels) o.channels.push_back({0, 0.01, false, false});
  EXPECT_NO_THROW(run(query, list, o));
  for (int more = 0; more < 2; ++more) {  // 12 channels and the silhouette are one more than fit
    o.channels.push_back({0, 0.01, false, false});
    EXPECT_THROW(run(query, list, o), std::invalid_argument);
  }
  o.channels = {};
  EXPECT_THROW(run(query, list, o), std::invalid_argument);
  o = depth_options();
  o.channels.push_back({2, 1, false, false});
  EXPECT_THROW(run(query, list, o), std::invalid_argument);
  o = depth_options();
  o.synthesized = {-1};
  EXPECT_THROW(run(query, list, o), std::invalid_argument);
}

TEST(Synthesis, StopsWhenAsked) {
  const synthesis::PatchImage query = without_depth(bumps(1));
  int calls = 0;
  Progress progress([&](int, const char*) { return ++calls < 4; });
  EXPECT_THROW(synthesis::synthesize(query, examples(3), depth_options(), {}, progress), Cancelled);
}

TEST(Pyramid, CollapsesToWhatItWasMadeOf) {
  const synthesis::PatchImage image = bumps(3, 101, 67);
  const synthesis::ImagePyramid p = synthesis::make_pyramid(image, 4);
  cv::Mat sum = p.band(1, 3);
  for (int l = 2; l >= 0; --l) sum = synthesis::expand(sum, p.coverage[l].size()) + p.band(1, l);
  EXPECT_LT(cv::norm(sum, image.planes[1], cv::NORM_INF, image.mask), 1e-4);
}

TEST(Pyramid, TheBackgroundIsFilledFromTheForeground) {
  cv::Mat plane(40, 50, CV_32F, cv::Scalar(1e9)), mask = cv::Mat::zeros(40, 50, CV_8U);
  for (int y = 10; y < 30; ++y)
    for (int x = 15; x < 35; ++x) plane.at<float>(y, x) = 3, mask.at<uchar>(y, x) = 255;
  plane.at<float>(0, 0) = NAN;
  EXPECT_LT(cv::norm(synthesis::extend(plane, mask), cv::Mat(40, 50, CV_32F, cv::Scalar(3)), cv::NORM_INF), 1e-4);
}

}  // namespace
}  // namespace parts::test
