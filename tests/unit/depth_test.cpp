// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "parts/base/error.h"
#include "parts/depth/alignment.h"
#include "parts/depth/reconstruct_depth.h"
#include "parts/depth/segment.h"
#include "parts/examples/render_example.h"
#include "parts/synthesis/pyramid.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

/// Busts, rendered as they are asked for; one may be kept out.
class Busts : public examples::ExampleSource {
 public:
  explicit Busts(int without = -1, bool back = true) : back_(back) {
    for (int k = 0; k < count; ++k)
      if (k != without) kept_.push_back(k);
    preset_ = {};
  }
  static constexpr int count = 8;

  int size() const override { return int(kept_.size()); }
  const std::string& name(int k) const override { return model(kept_[k]).name; }
  cv::Size image_size() const override { return {options().width, options().height}; }
  std::vector<render::View> views(int) const override { return {}; }
  examples::Example get(int k, const render::View& view) override {
    examples::Example e = see(kept_[k], view, light_);
    if (!back_) e.back_depth = cv::Mat();
    return e;
  }
  const io::ClassPreset& preset() const override { return preset_; }
  std::optional<examples::Light> light() const override { return light_; }
  void set_light(const examples::Light& light) override { light_ = light; }

  static examples::Example see(int k, const render::View& view, const examples::Light& light = {}) {
    examples::ExampleOptions o = options();
    o.light = light;
    return examples::render_example(model(k), view, 36, o);
  }

 private:
  static examples::ExampleOptions options() {
    examples::ExampleOptions o;
    o.width = 75, o.height = 100;
    return o;
  }
  static const examples::ClassModel& model(int k) {
    static const std::vector<examples::ClassModel> all = [] {
      std::vector<examples::ClassModel> list(count);
      for (int i = 0; i < count; ++i) {
        list[i].name = "bust_" + std::to_string(i);
        list[i].mesh = bust(unsigned(i + 1), 40);
        const Box box = list[i].mesh.bounds();
        list[i].center = box.center();
        list[i].size = box.sizes().maxCoeff() / 2;
      }
      return list;
    }();
    return all[k];
  }

  std::vector<int> kept_;
  bool back_;
  examples::Light light_;
  io::ClassPreset preset_;
};

depth::DepthOptions known_view() {
  depth::DepthOptions o;
  o.update_views = o.align = false;
  return o;
}

depth::DepthResult run(const depth::DepthQuery& query, examples::ExampleSource& source,
                       const depth::DepthOptions& options) {
  Progress progress;
  return depth::reconstruct_depth(query, source, options, progress);
}

/// Standard deviation of the difference as a share of the depth range.
double error(const cv::Mat& depth, const cv::Mat& truth, const cv::Mat& mask) {
  double low, high;
  cv::Scalar mean, deviation;
  cv::minMaxLoc(truth, &low, &high, nullptr, nullptr, mask);
  cv::meanStdDev(depth - truth, mean, deviation, mask);
  return deviation[0] / (high - low);
}

double overlap(const cv::Mat& a, const cv::Mat& b) {
  return double(cv::countNonZero(a & b)) / std::max(1, cv::countNonZero(a | b));
}

TEST(Depth, OfAMemberThatIsNotInTheDatabase) {
  double ours = 0, means = 0;
  for (int k : {0, 3, 6}) {
    Busts others(k);
    const examples::Example truth = Busts::see(k, {0, 0});
    const depth::DepthResult r = run({truth.image, truth.mask}, others, known_view());
    cv::Mat mean = cv::Mat::zeros(truth.depth.size(), CV_32F);
    for (int i = 0; i < others.size(); ++i) {
      const examples::Example e = others.get(i, {0, 0});
      mean += synthesis::extend(e.depth, e.mask) / others.size();
    }
    ours += error(r.depth, truth.depth, truth.mask);
    means += error(mean, truth.depth, truth.mask);
    EXPECT_TRUE(r.trusted);
    EXPECT_EQ(cv::countNonZero(r.mask != truth.mask), 0);
    EXPECT_EQ(cv::countNonZero(r.depth == r.depth), cv::countNonZero(truth.mask));
    // The camera shows the depths where they belong.
    EXPECT_NEAR(r.camera.scale, truth.camera.scale, 0.1 * truth.camera.scale);
    EXPECT_NEAR(cv::mean(r.depth, r.mask)[0], cv::mean(truth.depth, truth.mask)[0], 0.1 / truth.camera.scale * 36);
  }
  EXPECT_LT(ours, means);
}

TEST(Depth, ThreadsDoNotMatter) {
  Busts others(2);
  const examples::Example truth = Busts::see(2, {10, 5});
  depth::DepthOptions o;
  o.back = true;
  o.threads = 1;
  const depth::DepthResult one = run({truth.image, truth.mask}, others, o);
  o.threads = 3;
  const depth::DepthResult three = run({truth.image, truth.mask}, others, o);
  const auto same = [](const cv::Mat& a, const cv::Mat& b, const cv::Mat& mask) {
    return cv::norm(a, b, cv::NORM_INF, mask) == 0;
  };
  EXPECT_TRUE(same(one.depth, three.depth, one.mask));
  EXPECT_TRUE(same(one.back_depth, three.back_depth, one.mask));
  EXPECT_TRUE(same(one.example, three.example, one.mask));
}

TEST(Depth, FindsTheView) {
  int found = 0;
  const render::View views[] = {{25, 10}, {-20, -15}, {0, 20}};
  for (const render::View& view : views) {
    Busts others(1);
    const examples::Example truth = Busts::see(1, view);
    depth::DepthOptions o;
    o.align = false;
    const depth::DepthResult r = run({truth.image, truth.mask}, others, o);
    found += render::angle_between(r.view, view) < 8;
  }
  EXPECT_GE(found, 2);
}

TEST(Depth, FindsTheLight) {
  const Vec3 left(-0.6, 0.1, 0.8);
  double with = 0, without = 0;
  for (int k : {1, 4}) {
    Busts others(k);
    const examples::Example truth = Busts::see(k, {0, 0}, {left, 0.35});
    depth::DepthOptions o = known_view();
    const depth::DepthResult r = run({truth.image, truth.mask}, others, o);
    EXPECT_GT(r.light->direction.normalized().dot(left.normalized()), 0.85) << r.light->direction.transpose();
    EXPECT_EQ(others.light()->direction, examples::Light().direction) << "the source is left as it was";
    with += error(r.depth, truth.depth, truth.mask);
    o.update_light = false;
    without += error(run({truth.image, truth.mask}, others, o).depth, truth.depth, truth.mask);
    const examples::Example same = Busts::see(k, {0, 0});
    EXPECT_EQ(run({same.image, same.mask}, others, known_view()).light->direction, examples::Light().direction);
  }
  EXPECT_LT(with, 0.8 * without);
}

TEST(Depth, TheSourceKeepsItsLightAlsoWhenItFails) {
  /// Fails to give an example once its light has been changed for the n-th time.
  struct Failing : Busts {
    explicit Failing(int changes) : Busts(1), left(changes) {}
    void set_light(const examples::Light& light) override { --left, Busts::set_light(light); }
    examples::Example get(int k, const render::View& view) override {
      if (left <= 0) throw UserError("gone");
      return Busts::get(k, view);
    }
    int left;
  };
  const examples::Example truth = Busts::see(1, {0, 0}, {{-0.6, 0.1, 0.8}, 0.35});
  for (int changes : {1, 2, 3}) {
    Failing source(changes);
    EXPECT_THROW(run({truth.image, truth.mask}, source, known_view()), UserError);
    EXPECT_EQ(source.light()->direction, examples::Light().direction) << changes;
    EXPECT_EQ(source.light()->ambient, examples::Light().ambient) << changes;
  }
}

TEST(Depth, ProgressNeverRunsBackwards) {
  Busts others(2);
  const examples::Example truth = Busts::see(2, {10, 5});
  depth::DepthOptions o;
  o.back = o.segment = true;
  std::vector<int> percents;
  Progress progress([&](int percent, const char*) { return percents.push_back(percent), true; });
  depth::reconstruct_depth({truth.image, truth.mask}, others, o, progress);
  EXPECT_TRUE(std::is_sorted(percents.begin(), percents.end()));
  EXPECT_GE(percents.front(), 0);
  EXPECT_LE(percents.back(), 100);
  EXPECT_GT(std::set<int>(percents.begin(), percents.end()).size(), 15u);
}

TEST(Depth, TheBackIsBehindTheFront) {
  Busts others(4);
  const examples::Example truth = Busts::see(4, {0, 0});
  depth::DepthOptions o = known_view();
  o.back = true;
  const depth::DepthResult r = run({truth.image, truth.mask}, others, o);
  EXPECT_EQ(cv::countNonZero((r.back_depth < r.depth) & r.mask), 0);
  EXPECT_LT(error(r.back_depth, truth.back_depth, truth.mask), 0.25);
  Busts without(4, false);
  EXPECT_THROW(run({truth.image, truth.mask}, without, o), UserError);
}

TEST(Depth, AlignsATurnedAndLargerImage) {
  Busts others(5);
  const examples::Example truth = Busts::see(5, {0, 0});
  const cv::Mat turn = cv::getRotationMatrix2D({37, 50}, 15, 1.0);
  cv::Mat image, mask;
  cv::Mat matrix = turn * 1.6;
  cv::warpAffine(truth.image, image, matrix, {120, 160}, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(255));
  cv::warpAffine(truth.mask, mask, matrix, {120, 160}, cv::INTER_NEAREST);
  depth::DepthOptions o;
  o.update_views = false;
  const depth::DepthResult r = run({image, mask}, others, o);
  EXPECT_NEAR(r.rotation, -15, 6);
  EXPECT_NEAR(r.scale, 1 / 1.6, 0.12);
  cv::Mat depth;
  cv::warpAffine(synthesis::extend(truth.depth, truth.mask), depth, matrix, {120, 160}, cv::INTER_LINEAR,
                 cv::BORDER_REPLICATE);
  EXPECT_LT(error(r.depth, depth, mask), 0.1);
}

TEST(Depth, PlacementsTurnAboutThePointTheySay) {
  depth::Placement p;
  p.scale = 2, p.rotation = 90, p.from = {10, 20}, p.to = {5, 6};
  const cv::Vec2d up = p.matrix() * cv::Vec3d(11, 20, 1);  // anticlockwise: right becomes up
  EXPECT_NEAR(up[0], 5, 1e-9);
  EXPECT_NEAR(up[1], 4, 1e-9);
  const cv::Vec2d back = p.inverse() * cv::Vec3d(up[0], up[1], 1);
  EXPECT_NEAR(back[0], 11, 1e-9);
  EXPECT_NEAR(back[1], 20, 1e-9);
}

TEST(Depth, NoiseIsNotTrusted) {
  Busts all;
  cv::Mat image(100, 75, CV_8UC3), mask = cv::Mat::zeros(100, 75, CV_8U);
  cv::RNG noise(3);
  noise.fill(image, cv::RNG::UNIFORM, 0, 255);
  cv::rectangle(mask, {20, 10, 35, 70}, 255, cv::FILLED);
  const depth::DepthResult r = run({image, mask}, all, known_view());
  EXPECT_FALSE(r.trusted) << r.evidence.strangeness;
}

TEST(Depth, FindsTheForegroundBeforePlainAndUnevenBackgrounds) {
  Busts others(7);
  const examples::Example truth = Busts::see(7, {0, 0});
  const cv::Mat plain = depth::plain_background_mask(truth.image);
  EXPECT_GT(overlap(plain, truth.mask), 0.98);
  cv::Mat image = truth.image.clone();
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      if (!truth.mask.at<uchar>(y, x)) image.at<cv::Vec3b>(y, x) = {uchar(120 + x), uchar(60 + y / 2), 20};
  EXPECT_TRUE(depth::plain_background_mask(image).empty());
  depth::DepthOptions o = known_view();
  EXPECT_THROW(run({image, cv::Mat()}, others, o), UserError);
  o.segment = true;
  const depth::DepthResult r = run({image, cv::Mat()}, others, o);
  EXPECT_GT(overlap(r.mask, truth.mask), 0.9);
}

TEST(Depth, SaysWhatIsWrong) {
  Busts all;
  const examples::Example e = Busts::see(0, {0, 0});
  const depth::DepthOptions o = known_view();
  EXPECT_THROW(run({cv::Mat(), cv::Mat()}, all, o), UserError);
  EXPECT_THROW(run({cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(9)), cv::Mat()}, all, o), UserError);
  EXPECT_THROW(run({e.image, cv::Mat(10, 10, CV_8U, cv::Scalar(255))}, all, o), UserError);
  EXPECT_THROW(run({e.image, cv::Mat::zeros(e.mask.size(), CV_8U)}, all, o), UserError);
  depth::DepthOptions bad = o;
  bad.intensity = -1;
  EXPECT_THROW(run({e.image, e.mask}, all, bad), UserError);
  bad = o;
  bad.patch_sizes = {};
  EXPECT_THROW(run({e.image, e.mask}, all, bad), UserError);
  bad = o;
  bad.patch_sizes = {5, 6};
  EXPECT_THROW(run({e.image, e.mask}, all, bad), UserError);
}

}  // namespace
}  // namespace parts::test
