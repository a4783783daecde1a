// SPDX-License-Identifier: GPL-3.0-or-later
// Depth from one image: speed, and accuracy, leaving one object out, beside the
// class mean and the nearest example.
// bench_depth [speed|light|accuracy|views|sizes|lumps|ablations] [EVERY]: of the
// queries only each EVERY-th.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <random>
#include <sstream>

#include "bench/leave_one_out.h"
#include "bench/measure.h"
#include "parts/depth/gallery.h"
#include "parts/depth/small_level.h"
#include "parts/synthesis/pyramid.h"

using namespace parts;
using namespace parts::bench;

namespace {

std::string share(double value) { return text(100 * value, 3) + " %"; }

void accuracy(int every) {
  Table table("Depth, one object left out, 150 x 200: error as a share of the depth range",
              {"class", "queries", "ours", "of mean", "of nearest", "scaled", "of mean", "of nearest", "normals",
               "mean's", "nearest's", "back", "of mean", "wall s", "cpu s"});
  for (const char* name : {"heads", "hands", "bodies"}) {
    const auto all = open_class(name);
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
    figure(std::string("depth: ") + name + ", error of the mean's", Better::Lower, s.ours.offset / s.mean.offset);
    figure(std::string("depth: ") + name + ", normals of the mean's", Better::Lower, s.ours.angle / s.mean.angle);
  }
  table.note("mean: of all others, centroids aligned; nearest: the other whose image is most like the query's.");
}

void views(int every) {
  Table table(
      "Heads from up to 35 degrees of yaw and 25 of pitch",
      {"view", "queries", "within 5 degrees", "mean angle", "error", "of mean", "of nearest", "wall s", "cpu s"});
  const auto all = open_class("heads");
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
    figure(std::string("depth: view ") + (known ? "known" : "searched") + ", error of the mean's", Better::Lower,
           s.ours.offset / s.mean.offset);
  }
}

/// What lies above the neck, the narrowest row of the lower half of a bust.
void keep_head(examples::Example& e) {
  const cv::Rect box = cv::boundingRect(e.mask);
  int neck = box.y + box.height / 3, least = 1 << 30;
  for (int y = box.y + box.height / 3; y < box.br().y; ++y)
    if (const int width = cv::countNonZero(e.mask.row(y)); width < least) least = width, neck = y;
  cv::Mat below = cv::Mat::zeros(e.mask.size(), CV_8U);
  below.rowRange(neck, below.rows).setTo(255);
  e.mask.setTo(0, below);
  const cv::Rect head = cv::boundingRect(e.mask), frame({0, 0}, e.mask.size());
  const cv::Rect part = cv::Rect(head.x - 12, head.y - 12, head.width + 24, head.height + 24) & frame;
  for (cv::Mat* m : {&e.image, &e.depth, &e.mask}) *m = (*m)(part).clone();
  e.camera.width = part.width, e.camera.height = part.height;
}

/// Skin as it is: a scanned head by the rendered ones, in three lights; and noise.
void lumps(int every) {
  Table table("Lumps: a real head scan by the heads, in their light and others; heads with noise of 3 % of the range",
              {"query", "error", "of mean", "normals", "mean's", "roughness, of the truth's", "mean's", "cpu s"});
  const auto all = open_class("heads");
  const auto row = [&](const std::string& name, const Score& s) {
    table.row({name, share(s.ours.offset), text(s.ours.offset / s.mean.offset), text(s.ours.angle), text(s.mean.angle),
               text(s.ours.roughness), text(s.mean.roughness), text(s.cpu)});
    figure("depth: " + name + ", roughness of the truth's", Better::Lower, s.ours.roughness);
    figure("depth: " + name + ", normals of the mean's", Better::Lower, s.ours.angle / s.mean.angle);
  };
  depth::DepthOptions options;
  if (std::filesystem::exists(std::string(PARTS_DATA) + "/head_scan")) {
    const auto scan = open_class("head_scan", 300, 400);
    for (const Vec3& towards : {Vec3(0.3, 0.4, 0.85), Vec3(-0.6, 0.1, 0.8), Vec3(0, 0.7, 0.7)}) {
      scan->set_light({towards, 0.35});
      Score s;
      examples::Example head = scan->get(0, {0, 0});
      keep_head(head);
      compare_with_others(*all, head, {0, 0}, options, 1, s);
      std::ostringstream name;
      name << "scan, light " << towards.transpose();
      row(name.str(), s);
    }
  }
  Score s;
  options.align = options.update_views = false;
  const int step = std::max(every, 8), n = (all->size() + step - 1) / step;
  for (int k = 0; k < all->size(); k += step) {
    Others others(*all, k);
    examples::Example q = all->get(k, {0, 0});
    cv::Mat noise(q.image.size(), CV_16SC3), noisy;
    cv::RNG(unsigned(k + 1)).fill(noise, cv::RNG::NORMAL, 0, 8);
    cv::GaussianBlur(noise, noise, {3, 3}, 0);
    cv::add(q.image, noise, noisy, cv::noArray(), CV_8U);
    noisy.copyTo(q.image, q.mask);
    compare_with_others(others, q, {0, 0}, options, 1. / n, s);
  }
  row("heads with noise", s);
}

void ablations(int every) {
  Table table("Heads seen from (0, -22) (thesis Fig. 18, 19), error as a share of the depth range",
              {"variant", "error", "of mean", "normals"});
  const auto all = open_class("heads");
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
    const auto all = open_class("heads", width, width * 4 / 3);
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
        const auto all = open_class("heads", 200, 150);
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
        const auto all = open_class("heads", 200, 150);
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

/// Queries in another light than the one that examples are rendered in at first.
void light(int every) {
  Table table("Queries lit from the left, (-0.6, 0.1, 0.8), examples from (0.3, 0.4, 0.85)",
              {"class", "light", "error", "of mean", "of nearest", "normals", "cpu s"});
  for (const char* name : {"heads", "hands", "bodies"}) {
    const auto all = open_class(name), lit = open_class(name);
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
  if (what.empty() || what == "light") light(every);
  if (what.empty() || what == "accuracy") accuracy(every);
  if (what.empty() || what == "views") views(every);
  if (what.empty() || what == "sizes") sizes(every);
  if (what.empty() || what == "lumps") lumps(every);
  if (what.empty() || what == "ablations") ablations(every);
}
