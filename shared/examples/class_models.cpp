// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/examples/class_models.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "parts/base/error.h"
#include "parts/base/parallel.h"
#include "parts/render/surface_color.h"

namespace parts::examples {
namespace {

constexpr double kBound = 256e6;    // bytes of models that are kept
constexpr double kAlike = 2;        // sizes within this factor of the median share a scale
constexpr int kTexelsPerPixel = 8;  // finer images of a model are not needed

double bytes_of(const ClassModel& model) {
  const Mesh& m = model.mesh;
  double bytes = double(m.vertices.size()) * (sizeof(Vec3) + 24) + double(m.faces.size()) * sizeof(Triangle) +
                 double(m.wedges.size()) * sizeof(Wedges);
  for (const auto& levels : model.textures.images)
    for (const cv::Mat& level : levels) bytes += double(level.total() * level.elemSize());
  return bytes;
}

/// Drops what no example is large enough to show.
void drop_fine_levels(render::Textures& textures, int pixels) {
  for (auto& levels : textures.images) {
    std::size_t first = 0;
    while (first + 1 < levels.size() &&
           std::min(levels[first + 1].cols, levels[first + 1].rows) >= kTexelsPerPixel * pixels)
      ++first;
    levels.erase(levels.begin(), levels.begin() + long(first));
  }
}

void check_options(const ExampleOptions& options) {
  if (std::min(options.width, options.height) < 8 || std::max(options.width, options.height) > 8192)
    throw UserError("The images would be " + std::to_string(options.width) + " x " + std::to_string(options.height) +
                    " pixels; choose a width and a height from 8 to 8192.");
}

}  // namespace

ClassModels::ClassModels(const io::ModelDatabase& database, const std::vector<render::View>& views,
                         const ExampleOptions& options, Progress& progress)
    : database_(database), options_(options) {
  check_options(options);
  const std::string first_flaw = measure(views, progress);
  if (entries_.empty())
    throw UserError("None of the models in \"" + database.path() + "\" can be used; the first: " + first_flaw);
  settle_frame(progress);
}

/// Reads all models, a few at a time, and measures them. @return what is wrong with the first that is left out
std::string ClassModels::measure(const std::vector<render::View>& views, Progress& progress) {
  std::vector<Eigen::Matrix3d> rotations;
  for (const render::View& view : views) rotations.push_back(render::view_rotation(view, options_.up, options_.front));
  const int batch = thread_count(options_.threads);
  struct Read {
    std::optional<Mesh> mesh;
    std::string why;
    std::vector<std::string> missing{};
    Entry entry{};
  };
  std::string first_flaw;
  for (int first = 0; first < database_.size(); first += batch) {
    progress.at(double(first) / database_.size());
    std::vector<Read> reads(std::size_t(std::min(batch, database_.size() - first)));
    parallel_for(long(reads.size()), batch, [&](long begin, long end) {
      for (long r = begin; r < end; ++r) try {
          Mesh mesh = database_.load(first + int(r), {}, &reads[r].missing);
          const Box box = mesh.bounds();
          Entry& e = reads[r].entry;
          e.textures = mesh.textures;
          e.center = box.center();
          e.diagonal = box.diagonal().norm();
          e.extent.setZero();
          for (const Eigen::Matrix3d& rotation : rotations)
            e.extent = e.extent.cwiseMax(extent(mesh, e.center, rotation));
          reads[r].mesh = std::move(mesh);
        } catch (const UserError& error) {
          reads[r].why = error.what();
        }
    });
    for (std::size_t r = 0; r < reads.size(); ++r) {
      const int model = first + int(r);
      if (!reads[r].mesh) {
        if (first_flaw.empty()) first_flaw = reads[r].why;
        progress.log("skipped: " + database_.name(model) + " (" + reads[r].why + ")");
        continue;
      }
      io::log_missing(database_.name(model), reads[r].missing, progress);
      reads[r].entry.model = model;
      reads[r].entry.name = database_.name(model);
      entries_.push_back(std::move(reads[r].entry));
      keep(size() - 1, std::move(*reads[r].mesh));
    }
  }
  return first_flaw;
}

double ClassModels::shown_size(double diagonal) const {
  return diagonal < kAlike * median_ && median_ < kAlike * diagonal ? median_ : diagonal;
}

void ClassModels::settle_frame(Progress& progress) {
  std::vector<double> sizes;
  for (const Entry& e : entries_) sizes.push_back(e.diagonal);
  std::nth_element(sizes.begin(), sizes.begin() + long(sizes.size() / 2), sizes.end());
  median_ = sizes[sizes.size() / 2];
  frame_ = std::numeric_limits<double>::max();
  for (Entry& e : entries_) {
    e.size = shown_size(e.diagonal);
    if (e.size != median_) progress.log("rescaled: " + e.name);
    if (e.loaded) e.loaded->size = e.size;
    const Eigen::Vector2d room = (0.5 - options_.margin) * Eigen::Vector2d(options_.width, options_.height);
    for (int k = 0; k < 2; ++k)
      if (e.extent[k] > 0) frame_ = std::min(frame_, room[k] * e.size / e.extent[k]);
  }
}

void ClassModels::keep(int i, Mesh mesh) {
  Entry& e = entries_[i];
  e.loaded = std::make_unique<ClassModel>();
  e.loaded->name = e.name;
  e.loaded->mesh = std::move(mesh);
  e.loaded->center = e.center;
  e.loaded->size = e.size;
  e.bytes = bytes_of(*e.loaded);
  bytes_ += e.bytes;
  recent_.push_front(i);
  forget_beyond_bound(i);
}

void ClassModels::forget_beyond_bound(int but) {
  while (bytes_ > kBound && recent_.back() != but) {
    Entry& e = entries_[recent_.back()];
    bytes_ -= e.bytes;
    e.loaded.reset();
    recent_.pop_back();
  }
}

std::vector<std::string> ClassModels::files() const {
  std::vector<std::string> list;
  for (const Entry& e : entries_) {
    list.push_back(database_.file(e.model));
    list.insert(list.end(), e.textures.begin(), e.textures.end());
  }
  return list;
}

const ClassModel& ClassModels::get(int i) {
  Entry& e = entries_[i];
  if (!e.loaded)
    keep(i, database_.load(e.model));
  else
    recent_.splice(recent_.begin(), recent_, std::find(recent_.begin(), recent_.end(), i));
  ClassModel& model = *e.loaded;
  if (model.textures.images.size() != model.mesh.textures.size()) {  // its images are read when first seen
    model.textures = render::load_textures(model.mesh);
    drop_fine_levels(model.textures, std::max(options_.width, options_.height));
    bytes_ += bytes_of(model) - e.bytes;
    e.bytes = bytes_of(model);
    forget_beyond_bound(i);
  }
  return model;
}

}  // namespace parts::examples
