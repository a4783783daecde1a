// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "parts/examples/example.h"
#include "parts/synthesis/patch_image.h"

namespace parts::depth {

/// An example made ready for comparing: planes {intensity 0..1, depth, back
/// depth where there is one}. Depths in pixels, centred on the foreground's mean
/// front depth, so that they compare across objects, cameras and units.
struct ComparableExample {
  int object = 0;
  render::View view;
  synthesis::PatchImage image;
  render::Camera camera;
  double pixels_per_unit = 1;
  double middle = 0;  ///< world units: the mean front depth
};

/// Grey values 0..1, 32F, of a BGR image.
cv::Mat intensity(const cv::Mat& color);

/// A smaller image: halved until its longer side is at most `longest`.
/// Positions and depths are halved too.
synthesis::PatchImage thumbnail(const synthesis::PatchImage& image, int longest);

/// The objects of a source that take part in one reconstruction, and small
/// copies of what was seen of them, kept.
class Gallery {
 public:
  static constexpr int thumbnail_size = 64;

  /// @param most  objects that take part; of a larger source every so manieth,
  ///              which ones depends on the seed
  Gallery(examples::ExampleSource& source, int most, unsigned seed);

  int size() const { return int(objects_.size()); }
  const std::string& name(int k) const { return source_.name(objects_[k]); }
  bool has_any_view() const { return any_view_; }
  /// The views that are stored of any object; empty if it can be rendered from any.
  const std::vector<render::View>& stored_views() const { return views_; }
  cv::Size image_size() const { return source_.image_size(); }

  /// In what light they are seen; nothing where it is fixed.
  std::optional<examples::Light> light() const { return source_.light(); }
  void set_light(const examples::Light& light);

  /// The view of an object that is got when this one is asked for.
  render::View nearest(int k, const render::View& view) const;
  ComparableExample get(int k, const render::View& view);
  const synthesis::PatchImage& small(int k, const render::View& view);

 private:
  examples::ExampleSource& source_;
  std::vector<int> objects_;
  std::vector<render::View> views_;
  bool any_view_ = true;
  std::map<std::tuple<int, double, double>, synthesis::PatchImage> small_;
};

}  // namespace parts::depth
