// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/synthesis/level.h"

#include <algorithm>
#include <cmath>

#include "parts/base/parallel.h"
#include "parts/synthesis/pyramid.h"

namespace parts::synthesis {

cv::Mat ImagePyramid::band(int plane, int level) const {
  const std::vector<cv::Mat>& p = planes[plane];
  if (level + 1 >= int(p.size())) return p[level];
  return p[level] - expand(p[level + 1], p[level].size());
}

ImagePyramid make_pyramid(const PatchImage& image, int levels) {
  ImagePyramid result;
  cv::Mat coverage;
  cv::Mat(image.mask != 0).convertTo(coverage, CV_32F, 1 / 255.);
  result.coverage = gaussian_pyramid(coverage, levels);
  for (const cv::Mat& plane : image.planes)
    result.planes.push_back(plane.empty() ? std::vector<cv::Mat>(levels)
                                          : gaussian_pyramid(extend(plane, image.mask), levels));
  return result;
}

namespace {

// Detail of known planes exists at the coarsest level too.
cv::Mat channel_plane(const ImagePyramid& pyramid, const PatchChannel& channel, int level) {
  const std::vector<cv::Mat>& p = pyramid.planes[channel.plane];
  if (!channel.detail || p[level].empty()) return p[level];
  return p[level] -
         expand(level + 1 < int(p.size()) ? p[level + 1] : gaussian_pyramid(p[level], 2)[1], p[level].size());
}

double deviation(const std::vector<ImagePyramid>& examples, const PatchChannel& channel, int level) {
  double sum = 0, squares = 0, count = 0;
  for (const ImagePyramid& e : examples) {
    const cv::Mat plane = channel_plane(e, channel, level);
    for (int y = 0; y < plane.rows; ++y)
      for (int x = 0; x < plane.cols; ++x) {
        if (e.coverage[level].at<float>(y, x) < 0.5f) continue;
        const double v = plane.at<float>(y, x);
        sum += v, squares += v * v, ++count;
      }
  }
  if (count == 0) return 1;
  const double variance = squares / count - sum / count * (sum / count);
  return variance > 1e-20 ? std::sqrt(variance) : 1;
}

bool is_synthesized(const SynthesisOptions& options, int plane) {
  return std::count(options.synthesized.begin(), options.synthesized.end(), plane) > 0;
}

}  // namespace

LevelSetup make_setup(const std::vector<ImagePyramid>& examples, const SynthesisOptions& options, int level, int side,
                      double size) {
  LevelSetup setup;
  setup.level = level;
  setup.searched = level >= options.carried;
  PatchLayout& layout = setup.layout;
  const int channels = int(options.channels.size()) + 1;  // and the silhouette
  layout.side = side;
  layout.lanes = (channels + 3) / 4;
  layout.normalized.assign(layout.lanes, Lane::Zero());
  layout.factor.assign(layout.lanes, Lane::Zero());
  layout.everywhere.assign(layout.lanes, Lane::Zero());
  layout.active.assign(layout.lanes, Lane::Ones());
  layout.position = float(std::sqrt(options.position) / (size / (1 << level)));
  const double sigma = side / 4.0;
  double total = 0;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const double r2 = (i - side / 2) * (i - side / 2) + (j - side / 2) * (j - side / 2);
      layout.gaussian.push_back(float(std::exp(-r2 / (2 * sigma * sigma))));
      total += layout.gaussian.back();
    }
  for (float& g : layout.gaussian) g = float(g / total);
  for (size_t c = 0; c < options.channels.size(); ++c) {
    const PatchChannel& channel = options.channels[c];
    const double d = deviation(examples, channel, level);
    if (channel.normalize) {
      layout.normalized[c / 4][c % 4] = 1;
      layout.factor[c / 4][c % 4] = float(std::sqrt(channel.weight));
    }
    setup.scale.push_back(channel.normalize ? 1.f : float(std::sqrt(channel.weight) / d));
  }
  setup.scale.push_back(float(std::sqrt(options.silhouette)));
  layout.everywhere[(channels - 1) / 4][(channels - 1) % 4] = 1;
  return setup;
}

namespace {

PatchPlane pack(const ImagePyramid& pyramid, const std::vector<cv::Mat>& estimate, const SynthesisOptions& options,
                const LevelSetup& setup) {
  if (!setup.searched) return outline(pyramid.coverage[setup.level]);
  std::vector<cv::Mat> channels;
  for (size_t c = 0; c < options.channels.size(); ++c) {
    const PatchChannel& channel = options.channels[c];
    cv::Mat plane;
    const auto found = std::find(options.synthesized.begin(), options.synthesized.end(), channel.plane);
    if (!estimate.empty() && found != options.synthesized.end())
      plane = estimate[found - options.synthesized.begin()];
    else
      plane = channel_plane(pyramid, channel, setup.level);
    channels.push_back(plane.empty() ? plane : cv::Mat(plane * setup.scale[c]));
  }
  channels.push_back(pyramid.coverage[setup.level] * setup.scale.back());
  PatchPlane plane = make_patch_plane(channels, pyramid.coverage[setup.level], setup.layout);
  if (!options.centered) plane.centroid.setZero();
  return plane;
}

}  // namespace

LevelExample make_level_example(const ImagePyramid& pyramid, const SynthesisOptions& options, const LevelSetup& setup) {
  LevelExample e;
  e.plane = pack(pyramid, {}, options, setup);
  e.coverage = pyramid.coverage[setup.level];
  for (int s : options.synthesized) {
    e.bands.push_back(pyramid.band(s, setup.level));
    e.values.push_back(pyramid.planes[s][setup.level]);
  }
  return e;
}

PatchPlane make_level_query(const ImagePyramid& pyramid, const std::vector<cv::Mat>& estimate,
                            const SynthesisOptions& options, const LevelSetup& setup) {
  if (!estimate.empty()) return pack(pyramid, estimate, options, setup);
  ImagePyramid known = pyramid;
  for (size_t p = 0; p < known.planes.size(); ++p)
    if (is_synthesized(options, int(p))) known.planes[p].assign(known.coverage.size(), cv::Mat());
  return pack(known, {}, options, setup);
}

std::vector<Votes> vote(const PatchPlane& query, const std::vector<Match>& matches,
                        const std::vector<LevelExample>& examples, const PatchLayout& layout, int planes, int threads) {
  const cv::Size size(query.width, query.height);
  std::vector<Votes> votes(planes);
  for (Votes& v : votes)
    for (cv::Mat* m : {&v.weight, &v.value, &v.band}) *m = cv::Mat::zeros(size, CV_32F);
  const int r = layout.radius();
  parallel_for(query.height, threads, [&](long begin, long end) {
    for (int y = int(begin); y < end; ++y)
      for (int x = 0; x < query.width; ++x)
        for (int j = std::max(-r, -y); j <= std::min(r, query.height - 1 - y); ++j)
          for (int i = std::max(-r, -x); i <= std::min(r, query.width - 1 - x); ++i) {
            const Match& m = matches[query.index(x + i, y + j)];
            if (m.example < 0) continue;
            const LevelExample& e = examples[m.example];
            const int u = std::clamp(m.x - i, 0, e.plane.width - 1), v = std::clamp(m.y - j, 0, e.plane.height - 1);
            const float g = layout.gaussian[(r - j) * layout.side + r - i];
            for (int s = 0; s < planes; ++s) {
              votes[s].weight.at<float>(y, x) += g;
              votes[s].value.at<float>(y, x) += g * e.values[s].at<float>(v, u);
              votes[s].band.at<float>(y, x) += g * e.bands[s].at<float>(v, u);
            }
          }
  });
  return votes;
}

}  // namespace parts::synthesis
