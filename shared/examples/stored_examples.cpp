// SPDX-License-Identifier: GPL-3.0-or-later
// A mapping database: rasters of a MeshLab project.
#include "parts/examples/stored_examples.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "parts/base/error.h"
#include "parts/io/image_head.h"
#include "parts/io/mlp_project.h"
#include "parts/io/raster_io.h"
#include "parts/render/mlp_camera.h"

namespace parts::examples {
namespace {

namespace fs = std::filesystem;

constexpr double kBound = 256e6;  // bytes of examples that are kept

std::string pixels(const cv::Size& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height) + " pixels";
}

/// The view that ends a label, "name 30,-15", is cut off and returned.
std::optional<render::View> cut_view(std::string& label) {
  const std::size_t blank = label.find_last_of(' ');
  if (blank == std::string::npos || label.find(',', blank) == std::string::npos) return {};
  try {
    const std::vector<render::View> views = render::parse_views(label.substr(blank + 1));
    label.resize(blank);
    return views.at(0);
  } catch (const UserError&) {
    return {};
  }
}

/// From where a camera looks at models that stand like those of the class.
render::View view_of(const render::Camera& camera, const io::ClassPreset& preset) {
  const Eigen::Matrix3d frame =
      render::view_rotation({}, preset.up.value_or(Vec3(0, 1, 0)), preset.front.value_or(Vec3(0, 0, 1)));
  const Vec3 q = frame * camera.rotation.row(2).transpose();
  constexpr double degree = EIGEN_PI / 180;
  return {std::atan2(q.x(), q.z()) / degree, std::atan2(q.y(), std::hypot(q.x(), q.z())) / degree};
}

class StoredExamples : public ExampleSource {
 public:
  StoredExamples(const std::string& path, Progress& progress) : path_(path), preset_(io::read_class_preset(path)) {
    std::map<std::string, int> objects;
    for (const io::MlpRaster& raster : io::read_mlp(path).rasters) {
      if (raster.file_of(io::plane::kDepth).empty() || raster.file_of(io::plane::kColor).empty()) {
        progress.log("skipped: " + raster.label + " (no depth plane)");
        continue;
      }
      Shot shot{raster, render::from_mlp(raster.camera, raster.label), {}};
      std::string name = raster.label;
      const std::optional<render::View> view = cut_view(name);
      shot.view = view ? *view : view_of(shot.camera, preset_);
      check_files(raster);
      const auto [place, is_new] = objects.emplace(name, int(names_.size()));
      if (is_new) names_.push_back(name), shots_.emplace_back();
      shots_[place->second].push_back(std::move(shot));
    }
    if (names_.empty())
      throw UserError("The project \"" + path +
                      "\" has no raster with a depth plane; make one with \"Examples: Build Mapping Database\".");
  }

  int size() const override { return int(names_.size()); }
  const std::string& name(int object) const override { return names_[object]; }
  cv::Size image_size() const override { return size_; }
  std::vector<render::View> views(int object) const override {
    std::vector<render::View> views;
    for (const Shot& shot : shots_[object]) views.push_back(shot.view);
    return views;
  }
  std::vector<std::string> files() const override {
    std::vector<std::string> list;
    for (const auto& shots : shots_)
      for (const Shot& shot : shots)
        for (const io::MlpPlane& plane : shot.raster.planes) list.push_back(plane.file);
    return list;
  }
  const io::ClassPreset& preset() const override { return preset_; }

  Example get(int object, const render::View& view) override {
    std::vector<Shot>& shots = shots_[object];
    std::size_t best = 0;
    for (std::size_t s = 1; s < shots.size(); ++s)
      if (angle_between(shots[s].view, view) < angle_between(shots[best].view, view)) best = s;
    Shot& shot = shots[best];
    if (!shot.example.depth.empty()) return shot.example;
    Example example = load(shot, names_[object]);
    const double bytes = double(example.depth.total()) * 12;
    if (bytes_ + bytes <= kBound) shot.example = example, bytes_ += bytes;
    return example;
  }

 private:
  struct Shot {
    io::MlpRaster raster;
    render::Camera camera;
    render::View view;
    Example example{};  ///< once it has been read, as far as the bound allows
  };

  /// All files are there and, as far as their heads say, of one size.
  void check_files(const io::MlpRaster& raster) {
    for (const io::MlpPlane& plane : raster.planes) {
      if (plane.semantic != io::plane::kColor && plane.semantic != io::plane::kDepth &&
          plane.semantic != io::plane::kMask && plane.semantic != io::plane::kBackDepth)
        continue;
      std::error_code error;
      if (!fs::is_regular_file(plane.file, error))
        throw UserError("The file \"" + plane.file + "\" of the database \"" + path_ +
                        "\" is missing; put it back, or build the database again.");
      if (const std::optional<io::ImageHead> head = io::read_image_head(InputFile(plane.file)))
        check_size(plane.file, {int(std::min(head->width, 1e9)), int(std::min(head->height, 1e9))});
    }
  }
  void check_size(const std::string& file, const cv::Size& size) {
    if (size_.empty()) size_ = size;
    if (size != size_)
      throw UserError("The file \"" + file + "\" has " + pixels(size) + ", others of the database \"" + path_ +
                      "\" have " + pixels(size_) + "; build the database again.");
  }

  Example load(const Shot& shot, const std::string& name) {
    Example out;
    out.object = name;
    out.view = shot.view;
    const std::string image_file = shot.raster.file_of(io::plane::kColor),
                      depth_file = shot.raster.file_of(io::plane::kDepth),
                      mask_file = shot.raster.file_of(io::plane::kMask),
                      back_file = shot.raster.file_of(io::plane::kBackDepth);
    out.image = io::read_image(image_file).color;
    out.depth = io::read_depth(depth_file);
    check_size(image_file, out.image.size());
    check_size(depth_file, out.depth.size());
    out.camera = scaled(shot.camera, out.depth.size());
    out.mask = io::depth_mask(out.depth);
    if (!mask_file.empty()) {
      cv::bitwise_and(out.mask, io::read_mask(mask_file, out.depth.size()), out.mask);
      if (cv::countNonZero(out.mask) == 0)
        throw UserError("The mask \"" + mask_file + "\" hides all depth of its raster; build the database again.");
      out.depth.setTo(std::numeric_limits<float>::quiet_NaN(), ~out.mask);
    }
    if (!back_file.empty()) {
      out.back_depth = io::read_depth(back_file);
      check_size(back_file, out.back_depth.size());
      settle_back(out);
    }
    return out;
  }

  /// The back has a depth where the front has one, and is not before it.
  static void settle_back(Example& e) {
    for (int y = 0; y < e.depth.rows; ++y) {
      const float* front = e.depth.ptr<float>(y);
      float* back = e.back_depth.ptr<float>(y);
      for (int x = 0; x < e.depth.cols; ++x)
        if (!(back[x] >= front[x])) back[x] = front[x];
    }
    e.back_depth.setTo(std::numeric_limits<float>::quiet_NaN(), ~e.mask);
  }

  /// The camera for the images' size, which may not be the viewport's.
  static render::Camera scaled(render::Camera camera, const cv::Size& size) {
    const double by = double(size.width) / camera.width;
    if (size.width == camera.width && size.height == camera.height) return camera;
    camera.center *= by;
    camera.focal *= by;
    camera.scale *= by;
    camera.width = size.width;
    camera.height = size.height;
    return camera;
  }

  std::string path_;
  io::ClassPreset preset_;
  cv::Size size_;
  std::vector<std::string> names_;
  std::vector<std::vector<Shot>> shots_;  ///< of each object
  double bytes_ = 0;
};

}  // namespace

std::unique_ptr<ExampleSource> open_mapping_database(const std::string& path, Progress& progress) {
  return std::make_unique<StoredExamples>(path, progress);
}

}  // namespace parts::examples
