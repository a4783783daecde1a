// SPDX-License-Identifier: GPL-3.0-or-later
// Depth from one image: speed, the search beside the exact one, and accuracy,
// leaving one object out, beside the class mean and the nearest example.
// bench_depth [speed|search|light|accuracy|views|sizes|ablations] [EVERY]: of the
// queries only each EVERY-th.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <flann/flann.hpp>
#include <iostream>
#include <map>
#include <random>

#include "bench/measure.h"
#include "parts/depth/alignment.h"
#include "parts/depth/gallery.h"
#include "parts/depth/reconstruct_depth.h"
#include "parts/depth/view_search.h"
#include "parts/examples/examples.h"
#include "parts/io/model_database.h"
#include "parts/render/mask.h"
#include "parts/synthesis/level.h"
#include "parts/synthesis/pyramid.h"

using namespace parts;
using namespace parts::bench;

namespace {

/// A class of data/NAME, one object kept out.
class Others : public examples::ExampleSource {
 public:
  Others(examples::ExampleSource& all, int without) : all_(all), without_(without) {}
  int size() const override { return all_.size() - (without_ >= 0); }
  const std::string& name(int k) const override { return all_.name(of(k)); }
  cv::Size image_size() const override { return all_.image_size(); }
  std::vector<render::View> views(int k) const override { return all_.views(of(k)); }
  examples::Example get(int k, const render::View& view) override { return all_.get(of(k), view); }
  std::optional<examples::Light> light() const override { return all_.light(); }
  void set_light(const examples::Light& light) override { all_.set_light(light); }
  const io::ClassPreset& preset() const override { return all_.preset(); }

 private:
  int of(int k) const { return without_ >= 0 && k >= without_ ? k + 1 : k; }
  examples::ExampleSource& all_;
  int without_;
};

std::unique_ptr<examples::ExampleSource> open(const std::string& name, int width = 150, int height = 200) {
  Progress progress;
  examples::ExampleOptions options;
  options.width = width, options.height = height;
  return examples::open_examples(std::string(PARTS_DATA) + "/" + name, {{0, 0}}, options, progress);
}

struct Error {
  double offset = 0, scale = 0, angle = 0;  ///< shares of the depth range, degrees
  void add(const Error& e, double share) {
    offset += e.offset * share, scale += e.scale * share, angle += e.angle * share;
  }
};

cv::Vec3f normal(const cv::Mat& d, int x, int y) {
  const cv::Vec3f n((d.at<float>(y, x + 1) - d.at<float>(y, x - 1)) / 2,
                    (d.at<float>(y + 1, x) - d.at<float>(y - 1, x)) / 2, 1);
  return n / cv::norm(n);
}

/// Both in pixels, over the mask: after aligning the offset, and the scale too;
/// and the mean angle between normals.
Error compare(const cv::Mat& depth, const cv::Mat& truth, const cv::Mat& mask) {
  double low, high, n = 0, sd = 0, st = 0, sdd = 0, sdt = 0, stt = 0, angle = 0, normals = 0;
  cv::minMaxLoc(truth, &low, &high, nullptr, nullptr, mask);
  const auto in = [&](int x, int y) { return mask.at<uchar>(y, x) != 0; };
  for (int y = 1; y + 1 < mask.rows; ++y)
    for (int x = 1; x + 1 < mask.cols; ++x) {
      if (!in(x, y)) continue;
      const double d = depth.at<float>(y, x), t = truth.at<float>(y, x);
      ++n, sd += d, st += t, sdd += d * d, sdt += d * t, stt += t * t;
      if (!in(x - 1, y) || !in(x + 1, y) || !in(x, y - 1) || !in(x, y + 1)) continue;
      ++normals, angle += std::acos(std::min(1.f, normal(depth, x, y).dot(normal(truth, x, y))));
    }
  const double vd = sdd - sd * sd / n, vt = stt - st * st / n, c = sdt - sd * st / n, s = vd > 0 ? c / vd : 0;
  return {std::sqrt(std::max(0., vd + vt - 2 * c) / n) / (high - low),
          std::sqrt(std::max(0., vt - 2 * s * c + s * s * vd) / n) / (high - low), angle / normals * 180 / CV_PI};
}

/// An example's depth, moved so that its centroid lies on the query's.
cv::Mat moved(const cv::Mat& depth, const examples::Example& e, const examples::Example& query) {
  const cv::Point2d by = render::centroid(query.mask) - render::centroid(e.mask);
  const cv::Mat full = synthesis::extend(depth, e.mask);
  cv::Mat result(full.size(), CV_32F);
  for (int y = 0; y < full.rows; ++y)
    for (int x = 0; x < full.cols; ++x)
      result.at<float>(y, x) = full.at<float>(std::clamp(int(std::lround(y - by.y)), 0, full.rows - 1),
                                              std::clamp(int(std::lround(x - by.x)), 0, full.cols - 1));
  return result;
}

struct Score {
  Error ours, mean, nearest, back, back_mean;
  double wall = 0, cpu = 0, angle = 0;
  int count = 0, found = 0;
};

/// One query, and what the others say of it.
/// @param queries  where the query is rendered, if not like the others
void measure(examples::ExampleSource& all, int k, const render::View& view, const depth::DepthOptions& options,
             double share, Score& score, examples::ExampleSource* queries = nullptr) {
  Others others(all, k);
  const examples::Example q = (queries ? *queries : all).get(k, view);
  Progress quiet;
  const Stopwatch watch;
  const depth::DepthResult r = depth::reconstruct_depth({q.image, q.mask}, others, options, quiet);
  score.wall += watch.wall() * share, score.cpu += watch.cpu() * share;

  const double scale = q.camera.scale;
  const synthesis::PatchImage look{{depth::intensity(q.image)}, q.mask};
  cv::Mat mean = cv::Mat::zeros(q.depth.size(), CV_32F), back = mean.clone(), nearest;
  double least = 1e30;
  for (int i = 0; i < others.size(); ++i) {
    const examples::Example e = others.get(i, view);
    const double middle = cv::mean(e.depth, e.mask)[0];
    const cv::Mat depth = moved((e.depth - middle) * e.camera.scale, e, q);
    mean += depth / others.size();
    if (!e.back_depth.empty()) back += moved((e.back_depth - middle) * e.camera.scale, e, q) / others.size();
    const double d = depth::image_difference(look, {{depth::intensity(e.image)}, e.mask});
    if (d < least) least = d, nearest = depth;
  }
  score.ours.add(compare(r.depth * r.camera.scale, q.depth * scale, q.mask), share);
  score.mean.add(compare(mean, q.depth * scale, q.mask), share);
  score.nearest.add(compare(nearest, q.depth * scale, q.mask), share);
  if (options.back) {
    score.back.add(compare(r.back_depth * r.camera.scale, q.back_depth * scale, q.mask), share);
    score.back_mean.add(compare(back, q.back_depth * scale, q.mask), share);
  }
  const double away = examples::angle_between(r.view, view);
  score.angle += away * share;
  score.found += away <= 5;
  ++score.count;
}

std::string share(double value) { return text(100 * value, 3) + " %"; }

void accuracy(int every) {
  Table table("Depth, one object left out, 150 x 200: error as a share of the depth range",
              {"class", "queries", "ours", "of mean", "of nearest", "scaled", "of mean", "of nearest", "normals",
               "mean's", "nearest's", "back", "of mean", "wall s", "cpu s"});
  for (const char* name : {"heads", "hands", "bodies"}) {
    const auto all = open(name);
    depth::DepthOptions options;
    options.update_views = options.align = false;
    options.back = true;
    Score s;
    const int n = (all->size() + every - 1) / every;
    for (int k = 0; k < all->size(); k += every) measure(*all, k, {0, 0}, options, 1. / n, s);
    table.row({name, count(s.count), share(s.ours.offset), text(s.ours.offset / s.mean.offset),
               text(s.ours.offset / s.nearest.offset), share(s.ours.scale), text(s.ours.scale / s.mean.scale),
               text(s.ours.scale / s.nearest.scale), text(s.ours.angle), text(s.mean.angle), text(s.nearest.angle),
               share(s.back.offset), text(s.back.offset / s.back_mean.offset), text(s.wall), text(s.cpu)});
  }
  table.note("mean: of all others, centroids aligned; nearest: the other whose image is most like the query's.");
}

void views(int every) {
  Table table(
      "Heads from up to 35 degrees of yaw and 25 of pitch",
      {"view", "queries", "within 5 degrees", "mean angle", "error", "of mean", "of nearest", "wall s", "cpu s"});
  const auto all = open("heads");
  for (const bool known : {true, false}) {
    std::mt19937 engine(5);
    const auto uniform = [&](double most) { return most * (engine() / 2147483648.0 - 1); };
    Score s;
    const int n = (all->size() + every - 1) / every;
    for (int k = 0; k < all->size(); k += every) {
      const double yaw = uniform(35), pitch = uniform(25);
      depth::DepthOptions options;
      options.align = false;
      options.update_views = !known;
      if (known) options.views = {{yaw, pitch}};
      measure(*all, k, {yaw, pitch}, options, 1. / n, s);
    }
    table.row({known ? "known" : "searched", count(s.count), count(s.found), text(s.angle), share(s.ours.offset),
               text(s.ours.offset / s.mean.offset), text(s.ours.offset / s.nearest.offset), text(s.wall), text(s.cpu)});
  }
}

void ablations(int every) {
  Table table("Heads seen from (0, -22) (thesis Fig. 18, 19), error as a share of the depth range",
              {"variant", "error", "of mean", "normals"});
  const auto all = open("heads");
  const std::vector<render::View> four{{-20, 0}, {20, 0}, {-20, -40}, {20, -40}};
  depth::DepthOptions plain;
  plain.align = false;
  std::vector<std::pair<std::string, depth::DepthOptions>> variants;
  const auto add = [&](const char* name, std::vector<render::View> from, bool update,
                       const std::function<void(depth::DepthOptions&)>& change) {
    depth::DepthOptions o = plain;
    o.views = std::move(from), o.update_views = o.update_objects = update;
    change(o);
    variants.push_back({name, o});
  };
  const auto nothing = [](depth::DepthOptions&) {};
  add("one wrong view (0, 0)", {{0, 0}}, false, nothing);
  add("four fixed views", four, false, nothing);
  add("four views, updated", four, true, nothing);
  add("the view known", {{0, -22}}, false, nothing);
  add("... without iterations", {{0, -22}}, false,
      [](depth::DepthOptions& o) { o.max_iterations = 1, o.patch_sizes = {9}; });
  add("... without position", {{0, -22}}, false, [](depth::DepthOptions& o) { o.position = 0; });
  add("... without silhouettes", {{0, -22}}, false, [](depth::DepthOptions& o) { o.silhouette = 0; });
  add("... without depth", {{0, -22}}, false, [](depth::DepthOptions& o) { o.depth = 0; });
  const int n = (all->size() + every - 1) / every;
  for (const auto& [name, options] : variants) {
    Score s;
    for (int k = 0; k < all->size(); k += every) measure(*all, k, {0, -22}, options, 1. / n, s);
    table.row({name, share(s.ours.offset), text(s.ours.offset / s.mean.offset), text(s.ours.angle)});
  }
}

void sizes(int every) {
  Table table("Image size (heads; examples rendered at that size)",
              {"size", "error", "of mean", "normals", "wall s", "cpu s", "cpu s a megapixel"});
  for (const int width : {75, 150, 300, 600}) {
    const auto all = open("heads", width, width * 4 / 3);
    depth::DepthOptions options;
    options.update_views = options.align = false;
    Score s;
    const int step = std::max(every, 6), n = (all->size() + step - 1) / step;
    for (int k = 0; k < all->size(); k += step) measure(*all, k, {0, 0}, options, 1. / n, s);
    table.row({std::to_string(width) + " x " + std::to_string(width * 4 / 3), share(s.ours.offset),
               text(s.ours.offset / s.mean.offset), text(s.ours.angle), text(s.wall), text(s.cpu),
               text(s.cpu / (width * width * 4 / 3 * 1e-6))});
  }
}

void speed() {
  Table table("The thesis' size: 200 x 150, 12 examples, 3 levels 5/7/9, objects and views updated",
              {"foreground", "wall s", "cpu s", "peak", "verdict"});
  const Child masked = in_child(
      [] {
        const auto all = open("heads", 200, 150);
        Others others(*all, 0);
        const examples::Example q = all->get(0, {10, 5});
        Progress quiet;
        const Stopwatch watch;
        depth::reconstruct_depth({q.image, q.mask}, others, {}, quiet);
        return std::vector<double>{watch.wall(), watch.cpu()};
      },
      120);
  if (masked.ended)
    table.row({"masked", text(masked.figures[0]), text(masked.figures[1]), megabytes(masked.peak),
               verdict(masked.figures[0] < 2 && masked.peak < 500e6)});
  const Child full = in_child(
      [] {
        // Every pixel of query and examples is foreground: a plane with what the heads look like.
        const auto all = open("heads", 200, 150);
        std::vector<synthesis::PatchImage> examples;
        for (int k = 0; k < 13; ++k) {
          const examples::Example e = all->get(k, {0, 0});
          const double middle = cv::mean(e.depth, e.mask)[0];
          examples.push_back({{synthesis::extend(depth::intensity(e.image), e.mask),
                               synthesis::extend((e.depth - middle) * e.camera.scale, e.mask)},
                              cv::Mat(e.mask.size(), CV_8U, cv::Scalar(255))});
        }
        synthesis::PatchImage query = examples.back();
        query.planes[1] = cv::Mat();
        examples.pop_back();
        Progress quiet;
        const Stopwatch watch;
        synthesis::synthesize(query, examples, depth::synthesis_options({}), {}, quiet);
        return std::vector<double>{watch.wall(), watch.cpu()};
      },
      120);
  if (full.ended)
    table.row({"full frame", text(full.figures[0]), text(full.figures[1]), megabytes(full.peak),
               verdict(full.figures[0] < 4 && full.peak < 500e6)});
  table.note("full frame: the optimisation alone, every pixel foreground. The thesis took 40 minutes.");
}

/// Windows as rows, weighted as the query's are where all of them is foreground.
std::vector<float> rows(const synthesis::LevelExample& e, const std::vector<synthesis::Match>& windows,
                        const synthesis::PatchLayout& layout) {
  std::vector<float> all;
  synthesis::Window w;
  for (const synthesis::Match& m : windows) {
    synthesis::gather(e.plane, e.coverage, m.x, m.y, layout, w);
    for (int i = 0; i < layout.window(); ++i) {
      const float g = std::sqrt(layout.gaussian[i / layout.lanes]);
      for (int c = 0; c < 4; ++c) all.push_back(w.value[i][c] * g);
    }
    all.insert(all.end(), {w.position.x(), w.position.y()});
  }
  return all;
}

std::vector<synthesis::Match> inside(const synthesis::LevelExample& e, int k) {
  std::vector<synthesis::Match> list;
  for (int y = 0; y < e.plane.height; ++y)
    for (int x = 0; x < e.plane.width; ++x)
      if (e.plane.inside[e.plane.index(x, y)]) list.push_back({k, x, y});
  return list;
}

struct Searched {
  double squares = 0, build = 0, cpu = 0;
};

/// FLANN's randomised kd-trees over whole rows; what they propose is scored like ours.
Searched search_flann(const synthesis::LevelExample& query, const std::vector<synthesis::LevelExample>& examples,
                      const synthesis::PatchLayout& layout, int checks) {
  Searched result;
  const Stopwatch building;
  std::vector<synthesis::Match> windows;
  std::vector<float> data;
  for (size_t k = 0; k < examples.size(); ++k) {
    const std::vector<synthesis::Match> some = inside(examples[k], int(k));
    const std::vector<float> more = rows(examples[k], some, layout);
    windows.insert(windows.end(), some.begin(), some.end());
    data.insert(data.end(), more.begin(), more.end());
  }
  const size_t columns = data.size() / windows.size();
  flann::seed_random(1);
  flann::Index<flann::L2<float>> index(flann::Matrix<float>(data.data(), windows.size(), columns),
                                       flann::KDTreeIndexParams(4));
  index.buildIndex();
  result.build = building.cpu();
  const Stopwatch watch;
  const std::vector<synthesis::Match> asked = inside(query, 0);
  std::vector<float> points = rows(query, asked, layout), distances(asked.size());
  std::vector<int> found(asked.size());
  flann::Matrix<int> indices(found.data(), asked.size(), 1);
  flann::Matrix<float> far(distances.data(), asked.size(), 1);
  index.knnSearch(flann::Matrix<float>(points.data(), asked.size(), columns), indices, far, 1,
                  flann::SearchParams(checks));
  result.cpu = watch.cpu();
  synthesis::Window w;
  for (size_t i = 0; i < asked.size(); ++i) {
    synthesis::gather(query.plane, query.coverage, asked[i].x, asked[i].y, layout, w);
    const synthesis::Match& m = windows[found[i]];
    result.squares += synthesis::distance(w, examples[m.example].plane, m.x, m.y, layout, 1e30f);
  }
  return result;
}

/// The engine's own search of one level, its tree and its two passes.
Searched search_ours(const synthesis::LevelExample& query, const std::vector<synthesis::LevelExample>& examples,
                     const synthesis::PatchLayout& layout, bool exact) {
  Searched result;
  const Stopwatch building;
  std::unique_ptr<synthesis::PatchTree> tree;
  if (!exact) tree = std::make_unique<synthesis::PatchTree>(examples, layout, 60000, 0, 0);
  result.build = building.cpu();
  const Stopwatch watch;
  std::vector<synthesis::Match> matches(size_t(query.plane.width) * query.plane.height);
  synthesis::search(query.plane, query.coverage, examples, layout, tree.get(), 0, matches);
  result.cpu = watch.cpu();
  for (const synthesis::Match& m : matches)
    if (m.example >= 0) result.squares += m.distance;
  return result;
}

void search() {
  Table table("The search of windows of 9 x 9: heads, 150 x 200, 12 examples, depth known",
              {"", "mean squared distance", "of exact", "index, cpu s", "cpu us a query"});
  const auto all = open("heads");
  const synthesis::SynthesisOptions options = depth::synthesis_options({});
  std::vector<synthesis::ImagePyramid> pyramids;
  for (int k = 0; k < 13; ++k) {
    const examples::Example e = all->get(k, {0, 0});
    const double middle = cv::mean(e.depth, e.mask)[0];
    pyramids.push_back(
        synthesis::make_pyramid({{depth::intensity(e.image), (e.depth - middle) * e.camera.scale}, e.mask}, 1));
  }
  const synthesis::ImagePyramid asked = pyramids.front();
  pyramids.erase(pyramids.begin());
  const double queries = cv::countNonZero(asked.coverage[0] >= 0.5f);
  const synthesis::LevelSetup setup = synthesis::make_setup(pyramids, options, 0, 9, std::sqrt(queries));
  std::vector<synthesis::LevelExample> examples;
  for (const synthesis::ImagePyramid& p : pyramids)
    examples.push_back(synthesis::make_level_example(p, options, setup));
  const synthesis::LevelExample query = synthesis::make_level_example(asked, options, setup);
  const Searched exact = search_ours(query, examples, setup.layout, true);
  const auto add = [&](const char* name, const Searched& s) {
    table.row(
        {name, text(s.squares / queries), text(s.squares / exact.squares), text(s.build), text(s.cpu / queries * 1e6)});
  };
  add("ours: kd-tree over components, propagated", search_ours(query, examples, setup.layout, false));
  for (const int checks : {64, 256, 1024})
    add(("FLANN, 4 kd-trees, " + std::to_string(checks) + " checks").c_str(),
        search_flann(query, examples, setup.layout, checks));
  add("exact", exact);
}

/// Queries in another light than the one that examples are rendered in at first.
void light(int every) {
  Table table("Queries lit from the left, (-0.6, 0.1, 0.8), examples from (0.3, 0.4, 0.85)",
              {"class", "light", "error", "of mean", "of nearest", "normals", "cpu s"});
  for (const char* name : {"heads", "hands", "bodies"}) {
    const auto all = open(name), lit = open(name);
    lit->set_light({{-0.6, 0.1, 0.8}, 0.35});
    const int n = (all->size() + every - 1) / every;
    for (const int what : {0, 1, 2}) {
      depth::DepthOptions options;
      options.update_views = options.align = false;
      options.update_light = what == 1;
      Score s;
      for (int k = 0; k < all->size(); k += every)
        measure(what == 2 ? *lit : *all, k, {0, 0}, options, 1. / n, s, lit.get());
      table.row({name,
                 what == 0   ? "not searched"
                 : what == 1 ? "searched"
                             : "known",
                 share(s.ours.offset), text(s.ours.offset / s.mean.offset), text(s.ours.offset / s.nearest.offset),
                 text(s.ours.angle), text(s.cpu)});
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (std::string(PARTS_DATA).empty() || !std::filesystem::exists(std::string(PARTS_DATA) + "/heads")) {
    std::cout << "Skipped: no folder of optional models (PARTS_DATA) with heads in it.\n";
    return 0;
  }
  const std::string what = argc > 1 ? argv[1] : "";
  const int every = std::max(1, argc > 2 ? std::atoi(argv[2]) : 1);
  if (what.empty() || what == "speed") speed();
  if (what.empty() || what == "search") search();
  if (what.empty() || what == "light") light(every);
  if (what.empty() || what == "accuracy") accuracy(every);
  if (what.empty() || what == "views") views(every);
  if (what.empty() || what == "sizes") sizes(every);
  if (what.empty() || what == "ablations") ablations(every);
}
