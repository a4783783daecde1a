// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/depth/light_search.h"

#include <algorithm>
#include <cmath>

#include "parts/depth/small_level.h"
#include "parts/synthesis/pyramid.h"

namespace parts::depth {
namespace {

constexpr int most_objects = 6;
constexpr int enough = 600;      ///< pixels of foreground: with more, half the size does
constexpr double clearly = 0.9;  ///< of the distance in the present light

/// An object as it looks in any light.
struct Unlit {
  synthesis::PatchImage image;  ///< {colours alone, depth}
  cv::Mat normals;              ///< 32FC3, camera frame
};

Unlit unlit_object(const synthesis::PatchImage& image) {
  Unlit u{image, cv::Mat(image.mask.size(), CV_32FC3)};
  u.image.planes.resize(2);
  const cv::Mat depth = synthesis::extend(image.planes[1], image.mask);
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      const int l = std::max(0, x - 1), r = std::min(depth.cols - 1, x + 1);
      const int t = std::max(0, y - 1), b = std::min(depth.rows - 1, y + 1);
      const cv::Vec3f n((depth.at<float>(y, r) - depth.at<float>(y, l)) / float(r - l),
                        (depth.at<float>(t, x) - depth.at<float>(b, x)) / float(b - t), 1);
      u.normals.at<cv::Vec3f>(y, x) = n / cv::norm(n);
    }
  return u;
}

synthesis::PatchImage lit(const Unlit& object, const examples::Light& light, int longest) {
  synthesis::PatchImage image = object.image;
  image.planes[0] = object.image.planes[0].clone();
  const Vec3 d = light.direction.normalized();
  const cv::Vec3f to(float(d.x()), float(d.y()), float(d.z()));
  const float ambient = float(light.ambient);
  for (int y = 0; y < image.mask.rows; ++y)
    for (int x = 0; x < image.mask.cols; ++x)
      image.planes[0].at<float>(y, x) *=
          ambient + (1 - ambient) * std::max(0.f, object.normals.at<cv::Vec3f>(y, x).dot(to));
  return thumbnail(image, longest);
}

/// How far the query's patches are from those of objects in a light.
double patch_distance(const synthesis::PatchImage& query, const std::vector<Unlit>& objects,
                      const examples::Light& light, const DepthOptions& options) {
  const int longest = std::max(query.mask.cols, query.mask.rows);
  std::vector<synthesis::PatchImage> examples;
  for (const Unlit& object : objects) examples.push_back(lit(object, light, longest));
  synthesis::SynthesisOptions o = synthesis_options(options);
  o.position *= 0.4, o.silhouette *= 0.25;  // of which light changes nothing
  return small_distance(query, examples, o);
}

/// Turned away from the viewer's direction by an angle, towards an azimuth; degrees.
Vec3 direction(double slant, double azimuth) {
  const double s = slant * EIGEN_PI / 180, a = azimuth * EIGEN_PI / 180;
  return {std::sin(s) * std::cos(a), std::sin(s) * std::sin(a), std::cos(s)};
}

}  // namespace

examples::Light find_light(const synthesis::PatchImage& query, Gallery& gallery, const render::View& view,
                           const DepthOptions& options) {
  if (!gallery.light()) return {};
  const examples::Light present = *gallery.light();
  std::vector<Unlit> objects;
  gallery.set_light({present.direction, 1});  // as if from everywhere: colours alone
  const int count = std::min(most_objects, gallery.size());
  for (int i = 0; i < count; ++i) objects.push_back(unlit_object(gallery.small(i * gallery.size() / count, view)));
  gallery.set_light(present);
  synthesis::PatchImage small = query;
  small.planes.resize(1);
  if (cv::countNonZero(small.mask) > enough) small = thumbnail(small, Gallery::thumbnail_size / 2 + 1);
  small.planes.emplace_back();

  examples::Light best = present;
  double least = clearly * patch_distance(small, objects, present, options);
  const auto offer = [&](const examples::Light& light) {
    const double u = patch_distance(small, objects, light, options);
    if (u < least) least = u, best = light;
  };
  for (const double slant : {0., 35., 70.})
    for (int i = 0; i < (slant == 0 ? 1 : slant == 35 ? 6 : 8); ++i)
      offer({direction(slant, slant == 35 ? 60 * i : 45 * i), present.ambient});
  const examples::Light coarse = best;
  if (coarse.direction == present.direction) return best;
  const Vec3 side = coarse.direction.unitOrthogonal(), up = coarse.direction.cross(side);
  for (int i = 0; i < 6; ++i)
    offer({coarse.direction + 0.32 * (std::cos(i * EIGEN_PI / 3) * side + std::sin(i * EIGEN_PI / 3) * up),
           coarse.ambient});
  for (const double ambient : {0.15, 0.6}) offer({best.direction, ambient});
  return best;
}

}  // namespace parts::depth
