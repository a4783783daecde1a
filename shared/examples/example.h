// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "parts/io/class_preset.h"
#include "parts/render/camera.h"
#include "parts/render/light.h"

namespace parts::examples {

using render::Light;

/// An example of the mapping from appearance to depth (thesis 4.1): what a
/// camera sees of one object of the class. Rasters of one size.
struct Example {
  std::string object;  ///< its label
  render::View view;
  render::Camera camera;
  cv::Mat image;       ///< 8UC3, BGR
  cv::Mat depth;       ///< 32F, world units from the camera; NaN = background
  cv::Mat back_depth;  ///< the same of the farthest surface; empty where the database has none
  cv::Mat mask;        ///< 8U, 255 = object; exactly where depth is not NaN

  /// Pixels a world unit at the object: depth times this compares with columns
  /// and rows, and with other examples, whatever the model's units.
  double pixels_per_unit() const;
};

/// The examples of a class: objects, each seen from stored views or from any.
class ExampleSource {
 public:
  virtual ~ExampleSource() = default;

  virtual int size() const = 0;  ///< objects
  virtual const std::string& name(int object) const = 0;
  virtual cv::Size image_size() const = 0;
  /// The views that are stored of an object; none: it can be rendered from any.
  virtual std::vector<render::View> views(int object) const = 0;
  /// The example of that view, or of the stored view nearest to it. Not for
  /// several threads at once.
  /// @throws UserError  its files or model cannot be read
  virtual Example get(int object, const render::View& view) = 0;
  /// In what light examples are rendered; nothing where they are stored as they are.
  virtual std::optional<Light> light() const { return {}; }
  /// From now on.
  virtual void set_light(const Light&) {}
  /// The files that it is made of, which no output may replace.
  virtual std::vector<std::string> files() const { return {}; }
  /// What the database says about its class.
  virtual const io::ClassPreset& preset() const = 0;
};

}  // namespace parts::examples
