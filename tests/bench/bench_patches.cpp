// SPDX-License-Identifier: GPL-3.0-or-later
// The search for similar windows beside the exact one and FLANN's.

#include <cmath>
#include <filesystem>
#include <flann/flann.hpp>
#include <iostream>

#include "bench/leave_one_out.h"
#include "bench/measure.h"
#include "parts/depth/gallery.h"
#include "parts/depth/small_level.h"
#include "parts/synthesis/level.h"

using namespace parts;
using namespace parts::bench;

namespace {

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

void compare_searches() {
  Table table("The search of windows of 9 x 9: heads, 150 x 200, 12 examples, depth known",
              {"", "mean squared distance", "of exact", "index, cpu s", "cpu us a query"});
  const auto all = open_class("heads");
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

}  // namespace

int main() {
  if (std::string(PARTS_DATA).empty() || !std::filesystem::exists(std::string(PARTS_DATA) + "/heads")) {
    std::cout << "Skipped: no folder of optional models (PARTS_DATA) with heads in it.\n";
    return 0;
  }
  compare_searches();
}
