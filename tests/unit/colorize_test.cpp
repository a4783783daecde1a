// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "parts/base/error.h"
#include "parts/colorize/colorize_depth.h"
#include "parts/synthesis/usage_picture.h"

namespace parts::test {
namespace {

const cv::Size kSize(72, 72);
const float kNan = std::nanf("");

/// A disc with a bump somewhere near its middle; the bump is red, the rest
/// green. `tint` is added to all colours.
examples::Example disc(const std::string& name, cv::Point2d bump, double tint = 0) {
  examples::Example e;
  e.object = name;
  e.camera.width = kSize.width, e.camera.height = kSize.height;
  e.image = cv::Mat(kSize, CV_8UC3, cv::Scalar(255, 255, 255));
  e.depth = cv::Mat(kSize, CV_32F, cv::Scalar(kNan));
  e.mask = cv::Mat::zeros(kSize, CV_8U);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const double u = x - 36, v = y - 36, d = std::hypot(u - bump.x, v - bump.y);
      if (u * u + v * v > 30 * 30) continue;
      e.depth.at<float>(y, x) = float(100 + 0.005 * (u * u + v * v) - 6 * std::exp(-d * d / 30));
      e.mask.at<uchar>(y, x) = 255;
      const cv::Scalar c = d < 6 ? cv::Scalar(40, 40, 180) : cv::Scalar(60, 150, 60);
      for (int k = 0; k < 3; ++k) e.image.at<cv::Vec3b>(y, x)[k] = cv::saturate_cast<uchar>(c[k] + tint);
    }
  return e;
}

class Discs : public examples::ExampleSource {
 public:
  explicit Discs(std::vector<examples::Example> all) : all_(std::move(all)) {}
  int size() const override { return int(all_.size()); }
  const std::string& name(int object) const override { return all_[object].object; }
  cv::Size image_size() const override { return kSize; }
  std::vector<render::View> views(int) const override { return {render::View{}}; }
  examples::Example get(int object, const render::View&) override { return all_[object]; }
  const io::ClassPreset& preset() const override { return preset_; }

 private:
  std::vector<examples::Example> all_;
  io::ClassPreset preset_;
};

Discs some_discs() {
  return Discs({disc("north", {0, -8}), disc("south.obj", {0, 8}), disc("west", {-8, 0}), disc("east", {8, 2})});
}

double mean_difference(const cv::Mat& a, const cv::Mat& b, const cv::Mat& mask) {
  cv::Mat d;
  cv::absdiff(a, b, d);
  const cv::Scalar m = cv::mean(d, mask);
  return (m[0] + m[1] + m[2]) / 3;
}

colorize::ColorizeOptions quick() {
  colorize::ColorizeOptions o;
  o.patch_sizes = {7, 7};
  return o;
}

TEST(ColorizeDepth, TheBumpIsRedWhereItIs) {
  Discs source = some_discs();
  Progress silent;
  const examples::Example query = disc("query", {-5, 5});
  const colorize::ColorizeResult r = colorize::colorize_depth(query.depth, source, quick(), silent);
  EXPECT_LT(mean_difference(r.color, query.image, query.mask), 12);
  EXPECT_FALSE(r.aligned);
  const cv::Vec3b bump = r.color.at<cv::Vec3b>(36 + 5, 36 - 5), rest = r.color.at<cv::Vec3b>(36 - 15, 36 + 15);
  EXPECT_GT(bump[2], bump[1] + 60);
  EXPECT_GT(rest[1], rest[2] + 50);
  // All of the foreground has a colour and a source, nothing else has.
  EXPECT_EQ(cv::countNonZero((r.example >= 0) != (query.mask != 0)), 0);
  double sum = 0;
  for (double share : r.shares) sum += share;
  EXPECT_NEAR(sum, 1, 1e-9);
  for (const auto& level : r.objective)
    for (std::size_t i = 1; i < level.size(); ++i) EXPECT_GE(level[i], level[i - 1] - 1e-9);
}

TEST(ColorizeDepth, UnitOffsetAndPlaceOfTheDepthDoNotMatter) {
  Discs source = some_discs();
  Progress silent;
  const examples::Example query = disc("query", {5, 5});
  cv::Mat moved(150, 160, CV_32F, cv::Scalar(kNan)), large;
  cv::resize(query.depth, large, {}, 1.5, 1.5, cv::INTER_NEAREST);
  cv::Mat(large * 0.01 + 3).copyTo(moved(cv::Rect(40, 10, large.cols, large.rows)));
  const colorize::ColorizeResult r = colorize::colorize_depth(moved, source, quick(), silent);
  EXPECT_TRUE(r.aligned);
  const cv::Vec3b bump = r.color.at<cv::Vec3b>(10 + int(41 * 1.5), 40 + int(41 * 1.5));
  EXPECT_GT(bump[2], bump[1] + 50);
  EXPECT_EQ(cv::countNonZero((r.example >= 0) != (r.mask != 0)), 0);
}

TEST(ColorizeDepth, ExamplesAreChosenByLikenessOrByName) {
  Discs source = some_discs();
  Progress silent;
  colorize::ColorizeOptions o = quick();
  o.examples = 1;
  EXPECT_EQ(colorize::colorize_depth(disc("q", {-7, 1}).depth, source, o, silent).used,
            std::vector<std::string>{"west"});
  o.choose = {"south", "north"};
  const auto used = colorize::colorize_depth(disc("q", {0, -7}).depth, source, o, silent).used;
  EXPECT_EQ(used, (std::vector<std::string>{"north", "south.obj"}));
  o.choose = {"nobody"};
  EXPECT_THROW(colorize::colorize_depth(disc("q", {0, 0}).depth, source, o, silent), UserError);
}

TEST(ColorizeDepth, AnotherExposureIsHarmonizedAnotherBumpIsNot) {
  Progress silent;
  colorize::ColorizeOptions o = quick();
  Discs tinted({disc("plain", {1, 1}), disc("bright", {-6, 0}, 50)});
  const examples::Example query = disc("q", {0, 1});
  colorize::ColorizeResult r = colorize::colorize_depth(query.depth, tinted, o, silent);
  EXPECT_EQ(r.harmonized, std::vector<std::string>{"bright"});
  EXPECT_LT(mean_difference(r.color, query.image, query.mask), 12);
  Discs same({disc("plain", {1, 1}), disc("other", {-6, 0})});
  r = colorize::colorize_depth(query.depth, same, o, silent);
  EXPECT_TRUE(r.harmonized.empty());
}

TEST(ColorizeDepth, ADepthThatLiesElsewhereKeepsItsPixels) {
  Discs source = some_discs();
  Progress silent;
  examples::Example query = disc("q", {3, -4});
  cv::Mat small, depth(kSize, CV_32F, cv::Scalar(kNan));
  cv::resize(query.depth, small, kSize / 2, 0, 0, cv::INTER_NEAREST);
  small.copyTo(depth(cv::Rect({4, 6}, small.size())));  // half as large, in a corner of an image of the same size
  const colorize::ColorizeResult r = colorize::colorize_depth(depth, source, quick(), silent);
  EXPECT_TRUE(r.aligned);
  EXPECT_EQ(cv::countNonZero((depth == depth) != r.mask), 0);
  EXPECT_EQ(cv::countNonZero((r.example >= 0) != r.mask), 0);
}

TEST(ColorizeDepth, ExamplesThatDoNotGoTogetherAreLeftOut) {
  examples::Example other = disc("other", {2, 0});
  cv::Mat half = other.mask.clone();
  half.colRange(0, kSize.width / 2).setTo(0);
  other.image.setTo(cv::Scalar(200, 20, 20), half);  // half of it is blue
  Discs source({disc("plain", {1, 1}), other, disc("far", {-6, 0})});
  Progress silent;
  const examples::Example query = disc("q", {1, 1});
  const colorize::ColorizeResult r = colorize::colorize_depth(query.depth, source, quick(), silent);
  EXPECT_EQ(r.used, (std::vector<std::string>{"plain", "far"}));
  EXPECT_EQ(r.left_out, 0);
  Discs two({disc("plain", {1, 1}), other});
  const colorize::ColorizeResult alone = colorize::colorize_depth(query.depth, two, quick(), silent);
  EXPECT_EQ(alone.used, std::vector<std::string>{"plain"});
  EXPECT_EQ(alone.left_out, 1);
  colorize::ColorizeOptions chosen = quick();
  chosen.choose = {"plain", "other"};
  EXPECT_EQ(colorize::colorize_depth(query.depth, two, chosen, silent).used.size(), 2u);
}

TEST(ColorizeDepth, SameForAnyNumberOfThreadsAndSeedsVary) {
  Discs source = some_discs();
  Progress silent;
  colorize::ColorizeOptions o = quick();
  const examples::Example query = disc("q", {3, -4});
  o.threads = 1;
  const colorize::ColorizeResult one = colorize::colorize_depth(query.depth, source, o, silent);
  o.threads = 8;
  const colorize::ColorizeResult eight = colorize::colorize_depth(query.depth, source, o, silent);
  EXPECT_EQ(cv::norm(one.color, eight.color, cv::NORM_INF), 0);
  std::set<std::string> firsts;
  for (unsigned seed = 0; seed < 6; ++seed) {
    o.seed = seed;
    firsts.insert(colorize::colorize_depth(query.depth, source, o, silent).used[0]);
  }
  EXPECT_GT(firsts.size(), 1u);
}

TEST(ColorizeDepth, NothingToColor) {
  Discs source = some_discs();
  Progress silent;
  EXPECT_THROW(colorize::colorize_depth(cv::Mat(kSize, CV_32F, cv::Scalar(kNan)), source, quick(), silent), UserError);
  colorize::ColorizeOptions none = quick();
  none.examples = 0;
  EXPECT_THROW(colorize::colorize_depth(disc("q", {0, 0}).depth, source, none, silent), UserError);
}

TEST(UsagePicture, AColorAnExample) {
  Discs source = some_discs();
  Progress silent;
  const colorize::ColorizeResult r = colorize::colorize_depth(disc("q", {0, 0}).depth, source, quick(), silent);
  const cv::Mat picture = synthesis::usage_picture(r.example);
  EXPECT_EQ(picture.size(), r.mask.size());
  cv::Mat grey;
  cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
  EXPECT_EQ(cv::countNonZero((grey > 0) != (r.mask != 0)), 0);
}

}  // namespace
}  // namespace parts::test
