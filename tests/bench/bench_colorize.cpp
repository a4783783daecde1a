// SPDX-License-Identifier: GPL-3.0-or-later
// Colour by example, leaving one object out: how well features sit where the
// true image-map has them, beside the most similar example pasted; and time.
//   bench_colorize [depth|mesh|time] [EVERY]   of the queries only each EVERY-th

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "bench/measure.h"
#include "parts/colorize/colorize_depth.h"
#include "parts/colorize/colorize_mesh.h"
#include "parts/examples/examples.h"
#include "parts/render/atlas.h"
#include "parts/render/mask.h"
#include "parts/render/surface_color.h"

using namespace parts;
using namespace parts::bench;

namespace {

/// A class, one object kept out, its examples in memory.
class Others : public examples::ExampleSource {
 public:
  explicit Others(examples::ExampleSource& all) : all_(all) {
    for (int k = 0; k < all.size(); ++k) examples_.push_back(all.get(k, {}));
  }
  void leave_out(int k) { without_ = k; }
  const examples::Example& whole(int k) const { return examples_[k]; }
  int size() const override { return all_.size() - (without_ >= 0); }
  const std::string& name(int k) const override { return all_.name(of(k)); }
  cv::Size image_size() const override { return all_.image_size(); }
  std::vector<render::View> views(int k) const override { return all_.views(of(k)); }
  examples::Example get(int k, const render::View&) override { return examples_[of(k)]; }
  const io::ClassPreset& preset() const override { return all_.preset(); }
  std::vector<std::string> files() const override { return all_.files(); }

 private:
  int of(int k) const { return without_ >= 0 && k >= without_ ? k + 1 : k; }
  examples::ExampleSource& all_;
  std::vector<examples::Example> examples_;
  int without_ = -1;
};

/// Correlation of the gradients of two image-maps inside a mask, after each
/// channel of the first is matched to the second affinely.
double gradient_correlation(const cv::Mat& map, const cv::Mat& truth, const cv::Mat& mask) {
  cv::Mat inside;
  cv::erode(mask, inside, {}, {-1, -1}, 2, cv::BORDER_CONSTANT, 0);
  double both = 0, ours = 0, theirs = 0;
  for (int c = 0; c < 3; ++c) {
    cv::Mat a, t;
    cv::extractChannel(map, a, c), cv::extractChannel(truth, t, c);
    a.convertTo(a, CV_64F), t.convertTo(t, CV_64F);
    cv::Scalar mean_a, mean_t, sd;
    cv::meanStdDev(a, mean_a, sd, inside), cv::meanStdDev(t, mean_t, sd, inside);
    const double variance = cv::mean((a - mean_a).mul(a - mean_a), inside)[0];
    const double gain = cv::mean((a - mean_a).mul(t - mean_t), inside)[0] / std::max(variance, 1e-9);
    for (int y = 1; y + 1 < a.rows; ++y)
      for (int x = 1; x + 1 < a.cols; ++x) {
        if (!inside.at<uchar>(y, x)) continue;
        const auto slope = [&](const cv::Mat& m, int dx, int dy) {
          return m.at<double>(y + dy, x + dx) - m.at<double>(y - dy, x - dx);
        };
        for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1)}) {
          const double p = gain * slope(a, dx, dy), q = slope(t, dx, dy);
          both += p * q, ours += p * p, theirs += q * q;
        }
      }
  }
  return both / std::sqrt(ours * theirs + 1e-12);
}

/// An example's image, its centroid on another's.
cv::Mat pasted(const examples::Example& from, const cv::Mat& onto) {
  const cv::Point2d shift = render::centroid(onto) - render::centroid(from.mask);
  cv::Mat out;
  cv::warpAffine(from.image, out, cv::Matx23d(1, 0, shift.x, 0, 1, shift.y), onto.size(), cv::INTER_LINEAR,
                 cv::BORDER_REPLICATE);
  return out;
}

/// What a class gave: ours, pasted, how often ours was better.
struct Score {
  double ours = 0, nearest = 0, seconds = 0;
  int better = 0, count = 0;
  void add(double a, double b, double cpu) { ours += a, nearest += b, seconds += cpu, better += a > b, ++count; }
  std::vector<std::string> cells(const std::string& name) const {
    return {name,
            std::to_string(count),
            text(ours / count, 2),
            text(nearest / count, 2),
            nearest > 0 ? ratio(ours / nearest) : "",
            std::to_string(better),
            std::to_string(count - better),
            text(seconds / count, 2)};
  }
};
const std::vector<std::string> kHead{"class", "maps",   "correlation", "nearest pasted",
                                     "ratio", "better", "faulty",      "cpu s"};

std::string folder(const std::string& name) { return std::string(PARTS_DATA) + "/" + name; }

examples::ExampleOptions unlit(int width, int height) {
  examples::ExampleOptions o;
  o.width = width, o.height = height, o.light.ambient = 1, o.back = false;
  return o;
}

void depth(int every) {
  Table table("Colorize Depth Map, 150 x 200, one object left out each time", kHead);
  for (const auto& [name, examples] : {std::pair("heads", 2), std::pair("hands", 2), std::pair("bodies", 1),
                                       std::pair("bodies", 2), std::pair("fish", 2)}) {
    if (!std::filesystem::exists(folder(name))) continue;
    Progress silent;
    const auto all = examples::open_examples(folder(name), {render::View{}}, unlit(150, 200), silent);
    Others others(*all);
    colorize::ColorizeOptions options;
    options.examples = examples;
    Score score;
    for (int q = 0; q < all->size(); q += every) {
      others.leave_out(q);
      const examples::Example& query = others.whole(q);
      const Stopwatch watch;
      const colorize::ColorizeResult r = colorize::colorize_depth(query.depth, others, options, silent);
      const double cpu = watch.cpu();
      for (int k = 0; k < others.size(); ++k)
        if (others.name(k) == r.used[0])
          score.add(gradient_correlation(r.color, query.image, query.mask),
                    gradient_correlation(pasted(others.get(k, {}), query.mask), query.image, query.mask), cpu);
    }
    const std::string what =
        std::string(name) + ", " + std::to_string(examples) + (examples == 1 ? " example" : " examples");
    table.row(score.cells(what));
    figure("colour of a depth map: " + what + ", correlation", Better::Higher, score.ours / score.count);
  }
  table.note("Correlation of gradients with those of the true image-map, after matching each channel affinely.");
  table.note("Faulty: features sit no better than those of the most similar example, pasted centroid on centroid.");
}

colorize::ColorizeMeshOptions mesh_options(int width, int height, int examples) {
  colorize::ColorizeMeshOptions o;
  o.views = render::parse_views("0,0; 60,0; 120,0; 180,0; -120,0; -60,0; 0,75; 0,-75");
  o.rendering = unlit(width, height);
  o.examples = examples;
  return o;
}

/// A folder of a class without one object, as links.
std::filesystem::path without(const std::string& name, const std::string& object) {
  namespace fs = std::filesystem;
  const fs::path to = fs::current_path() / "colorize_models";
  fs::remove_all(to);
  fs::create_directories(to);
  for (const auto& entry : fs::directory_iterator(folder(name)))
    if (entry.path().stem() != object) fs::create_symlink(entry.path(), to / entry.path().filename());
  return to;
}

void meshes(int every) {
  Table table("Colorize Mesh, seen from 6 views between those of the synthesis, one object left out each time", kHead);
  for (const auto& [name, examples] : {std::pair("heads", 2), std::pair("hands", 2), std::pair("bodies", 1)}) {
    if (!std::filesystem::exists(folder(name))) continue;
    Progress silent;
    const io::ModelDatabase all(folder(name), silent);
    const colorize::ColorizeMeshOptions options = mesh_options(300, 400, examples);
    Score score;
    for (int q = 0; q < all.size(); q += every) {
      const io::ModelDatabase rest(without(name, std::filesystem::path(all.name(q)).stem()).string(), silent);
      examples::ClassModels models(rest, options.views, options.rendering, silent);
      examples::ClassModel truth{all.name(q), all.load(q), {}, Vec3::Zero(), 1};
      truth.textures = render::load_textures(truth.mesh);
      truth.center = truth.mesh.bounds().center();
      truth.size = models.shown_size(truth.mesh.bounds().diagonal().norm());
      const Stopwatch watch;
      const colorize::MeshColors colors = colorize::colorize_mesh(truth.mesh, models, options, silent);
      const double cpu = watch.cpu();
      examples::ClassModel found = truth;
      const int size = 1024;
      found.mesh.wedges = render::make_atlas(truth.mesh, size).wedges;
      found.textures.images = {{colorize::bake_texture(truth.mesh, found.mesh.wedges, size, colors, 0).color}};
      double ours = 0, nearest = 0;
      for (int k = 0; k < models.size(); ++k)
        if (models.name(k) == colors.used[0])
          for (double yaw : {30., 90., 150., 210., 270., 330.}) {
            const examples::ExampleOptions look = unlit(150, 200);
            const double frame = models.frame() / 2;
            const examples::Example t = examples::render_example(truth, {yaw, 20}, frame, look);
            const examples::Example n = examples::render_example(models.get(k), {yaw, 20}, frame, look);
            ours +=
                gradient_correlation(examples::render_example(found, {yaw, 20}, frame, look).image, t.image, t.mask) /
                6;
            nearest += gradient_correlation(pasted(n, t.mask), t.image, t.mask) / 6;
          }
      score.add(ours, nearest, cpu);
    }
    table.row(score.cells(name));
    figure(std::string("colour of a mesh: ") + name + ", correlation", Better::Higher, score.ours / score.count);
  }
}

void time() {
  if (!std::filesystem::exists(folder("heads"))) return;
  Progress silent;
  const auto all = examples::open_examples(folder("heads"), {render::View{}}, unlit(200, 150), silent);
  Others others(*all);
  others.leave_out(0);
  Table table("Time", {"what", "wall s", "cpu s", "target s"});
  const Times one = best_of([&] { colorize::colorize_depth(others.whole(0).depth, others, {}, silent); });
  table.row({"a depth map of 200 x 150, 23 heads in memory, 2 used", text(one.wall), text(one.cpu), "1"});
  const Stopwatch watch;
  {
    const auto fresh = examples::open_examples(folder("heads"), {render::View{}}, unlit(150, 200), silent);
    for (int k = 0; k < fresh->size(); ++k) {
      colorize::ColorizeOptions options;
      options.seed = unsigned(k);
      colorize::colorize_depth(fresh->get(k, {}).depth, *fresh, options, silent);
    }
  }
  table.row(
      {"24 depth maps of 150 x 200 from 24 heads, reading them too", text(watch.wall()), text(watch.cpu()), "30"});
  for (const char* name : {"heads", "bodies"}) {
    const io::ModelDatabase models(folder(name), silent);
    const Mesh query = models.load(0);
    const colorize::ColorizeMeshOptions options = mesh_options(300, 400, 2);
    const Times mesh = best_of(
        [&] {
          examples::ClassModels read(models, options.views, options.rendering, silent);
          const colorize::MeshColors colors = colorize::colorize_mesh(query, read, options, silent);
          colorize::bake_texture(query, render::make_atlas(query, 1024).wedges, 1024, colors, 0);
        },
        1);
    table.row({"a mesh of " + count(query.vertex_count()) + " vertices, texture of 1024, reading " +
                   std::to_string(models.size()) + " " + name,
               text(mesh.wall), text(mesh.cpu), "15 (9,000 vertices)"});
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 && !std::isdigit(argv[1][0]) ? argv[1] : "";
  const int every = std::max(1, argc > 2 ? std::atoi(argv[2]) : argc > 1 && what.empty() ? std::atoi(argv[1]) : 1);
  if (what.empty() || what == "depth") depth(every);
  if (what.empty() || what == "meshes") meshes(std::max(every, what.empty() ? 4 : 1));
  if (what.empty() || what == "time") time();
}
