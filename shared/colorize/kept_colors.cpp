// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/colorize/kept_colors.h"

#include <cmath>

#include "parts/base/parallel.h"
#include "parts/render/rasterize.h"

namespace parts::colorize {

std::vector<cv::Mat> kept_pixels(const examples::ClassModel& mesh, const std::vector<char>& kept_faces,
                                 const std::vector<examples::Example>& views) {
  std::vector<cv::Mat> all;
  for (const examples::Example& view : views) {
    render::RenderOptions plain;
    plain.colors = false;
    const cv::Mat face = render::render(mesh.mesh, {}, view.camera, plain).face;
    cv::Mat kept = cv::Mat::zeros(face.size(), CV_8U);
    for (int y = 0; y < face.rows; ++y)
      for (int x = 0; x < face.cols; ++x)
        if (const int f = face.at<int>(y, x); f >= 0 && kept_faces[f]) kept.at<uchar>(y, x) = 255;
    all.push_back(kept);
  }
  return all;
}

std::vector<Eigen::Vector3f> corrections(const std::vector<Vec3>& vertices, const std::vector<Eigen::Vector3f>& found,
                                         const std::vector<Eigen::Vector3f>& own, const std::vector<char>& kept,
                                         int threads) {
  constexpr std::size_t kSamples = 3000;
  constexpr double kColor = 0.05, kNear = 0.04, kFar = 0.25;  // distances that count 1
  constexpr double kNearWeight = 20, kAnywhere = 1e-3;
  std::vector<int> samples;
  for (std::size_t v = 0; v < kept.size(); ++v)
    if (kept[v]) samples.push_back(int(v));
  const std::size_t step = samples.size() / kSamples + 1;
  std::vector<Eigen::Vector3f> all(vertices.size(), Eigen::Vector3f::Zero());
  parallel_for(long(vertices.size()), threads, [&](long begin, long end) {
    for (long v = begin; v < end; ++v) {
      if (kept[v]) {
        all[v] = own[v] - found[v];
        continue;
      }
      double total = 1e-12;
      Vec3 sum = Vec3::Zero();
      for (std::size_t i = 0; i < samples.size(); i += step) {
        const int s = samples[i];
        const Eigen::Vector3f d =
            (found[v] - found[s]).cwiseProduct(Eigen::Vector3f(1, 2, 2));  // tints tell things apart
        const double color = d.squaredNorm() / (kColor * kColor);
        if (!(color < 20)) continue;
        const double place = (vertices[v] - vertices[s]).squaredNorm();
        const double weight = std::exp(-color) * (kNearWeight * std::exp(-place / (kNear * kNear)) +
                                                  std::exp(-place / (kFar * kFar)) + kAnywhere);
        total += weight;
        sum += weight * (own[s] - found[s]).cast<double>();
      }
      all[v] = (sum / total).cast<float>();
    }
  });
  return all;
}

}  // namespace parts::colorize
