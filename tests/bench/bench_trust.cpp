// SPDX-License-Identifier: GPL-3.0-or-later
// How well a depth says that it is not to be trusted: members of the class, in
// known and unknown views and lights, members of other classes, cartoons and
// textures; a result is bad where it is worse than the class mean.
// bench_trust [EVERY [CLASS [KIND]]]: of the queries only each EVERY-th; one line
// each and a table.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <random>

#include "bench/leave_one_out.h"
#include "bench/measure.h"
#include "parts/depth/trust.h"

using namespace parts;
using namespace parts::bench;

namespace {

/// A kind of query, and how it went.
struct Kind {
  std::string name;
  int queries = 0, trusted = 0, bad = 0, trusted_bad = 0;
};

/// Fewer tones, and lines where they meet.
cv::Mat cartoon(const cv::Mat& image) {
  cv::Mat grey, out;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  cv::Mat tones(1, 256, CV_8U);
  for (int i = 0; i < 256; ++i) tones.at<uchar>(i) = uchar(i < 90 ? 60 : i < 170 ? 150 : 235);
  cv::LUT(grey, tones, grey);
  cv::Mat lines;
  cv::morphologyEx(grey, lines, cv::MORPH_GRADIENT, cv::Mat::ones(3, 3, CV_8U));
  grey.setTo(0, lines > 40);
  cv::cvtColor(grey, out, cv::COLOR_GRAY2BGR);
  return out;
}

/// Blotches instead of what the object looks like.
cv::Mat texture(cv::Size size, unsigned seed) {
  cv::Mat small(size.height / 6 + 2, size.width / 6 + 2, CV_8UC3), out;
  cv::RNG(seed).fill(small, cv::RNG::UNIFORM, 0, 255);
  cv::resize(small, out, size, 0, 0, cv::INTER_CUBIC);
  return out;
}

struct Trial {
  std::string kind;
  examples::Example query;
  render::View view;
};

void run(examples::ExampleSource& database, int without, const Trial& trial, Kind& kind) {
  Others others(database, without);
  depth::DepthOptions options;
  options.align = false;
  Progress quiet;
  Score score;
  depth::DepthResult r;
  try {
    r = compare_with_others(others, trial.query, trial.view, options, 1, score);
  } catch (const UserError& e) {
    std::cout << trial.kind << ": " << e.what() << "\n";
    return;
  }
  const double ratio = score.ours.offset / score.mean.offset;
  const bool bad = ratio > 1;
  ++kind.queries, kind.trusted += r.trusted, kind.bad += bad, kind.trusted_bad += bad && r.trusted;
  const depth::Evidence& e = r.evidence;
  std::cout << "trial," << trial.kind << "," << trial.query.object << "," << ratio << "," << e.strangeness << ","
            << e.silhouette << "," << e.halves << "," << e.view_margin << ","
            << render::angle_between(r.view, trial.view) << "," << r.trusted << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string data = PARTS_DATA;
  if (data.empty() || !std::filesystem::exists(data + "/heads")) {
    std::cout << "Skipped: no folder of optional models (PARTS_DATA) with heads in it.\n";
    return 0;
  }
  const int every = std::max(1, argc > 1 ? std::atoi(argv[1]) : 1);
  Kind all{"all"};
  Table table("Trust: a result is bad where its error is larger than the class mean's",
              {"queries", "", "bad", "trusted", "of them bad"});
  const std::vector<std::string> classes{"heads", "hands", "bodies"};
  std::cout << "trial,kind,object,of mean,strangeness,silhouette,halves,view margin,view off,trusted\n";
  for (size_t c = 0; c < classes.size(); ++c) {
    if (argc > 2 && classes[c] != argv[2]) continue;
    const auto database = open_class(classes[c]), lit = open_class(classes[c]);
    lit->set_light({{-0.6, 0.1, 0.8}, 0.35});
    const auto foreign = open_class(classes[(c + 1) % classes.size()]);
    std::mt19937 engine(7);
    const auto uniform = [&](double most) { return most * (engine() / 2147483648.0 - 1); };
    for (const char* what : {"front", "view", "view and light", "other class", "cartoon", "texture"}) {
      Kind kind{classes[c] + ", " + what};
      const std::string w = what;
      if (argc > 3 && w != argv[3]) continue;
      examples::ExampleSource& from = w == "other class" ? *foreign : w == "view and light" ? *lit : *database;
      for (int k = 0; k < from.size(); k += every) {
        const bool turned = w.substr(0, 4) == "view";
        const render::View view{turned ? uniform(35) : 0, turned ? uniform(25) : 0};
        Trial trial{kind.name, from.get(k, view), view};
        if (w == "cartoon") trial.query.image = cartoon(trial.query.image);
        if (w == "texture") trial.query.image = texture(trial.query.image.size(), unsigned(k + 1));
        run(*database, w == "other class" ? -1 : k, trial, kind);
      }
      table.row({kind.name, count(kind.queries), count(kind.bad), count(kind.trusted), count(kind.trusted_bad)});
      all.queries += kind.queries, all.trusted += kind.trusted, all.bad += kind.bad;
      all.trusted_bad += kind.trusted_bad;
    }
  }
  table.row({all.name, count(all.queries), count(all.bad), count(all.trusted), count(all.trusted_bad)});
  const int caught = all.bad - all.trusted_bad, distrusted = all.queries - all.trusted;
  table.note("Of those not trusted " + text(100. * caught / std::max(1, distrusted)) +
             " % were bad (precision), of the bad " + text(100. * caught / std::max(1, all.bad)) +
             " % were not trusted (recall).");
}
