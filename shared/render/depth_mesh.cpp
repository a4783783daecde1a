// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/depth_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "parts/base/error.h"
#include "parts/base/files.h"
#include "parts/base/memory.h"
#include "parts/mesh/attributes.h"
#include "parts/render/depth_jump.h"
#include "parts/render/pixel_faces.h"

namespace parts::render {
namespace {

constexpr double kLeastThickness = 0.5;  // pixels, of a solid
constexpr int kWallSteps = 64;           // most triangles across a wall
constexpr double kBytesPerPixel = 350;   // measured: mesh and layer of a textured sheet

/// Front and back of each pixel, and what is torn.
class Solid {
 public:
  Solid(const cv::Mat& depth, const cv::Mat& back, const Camera& camera)
      : camera_(camera), depth_(depth), back_(back.clone()), width_(depth.cols), closed_(!back.empty()) {}

  bool closed() const { return closed_; }
  bool has(int p) const { return !std::isnan(front(p)); }
  double front(int p) const { return depth_.at<float>(p / width_, p % width_); }
  double back(int p) const { return back_.at<float>(p / width_, p % width_); }
  double pixel_width(double depth) const { return camera_.focal > 0 ? depth / camera_.focal : 1 / camera_.scale; }
  Vec3 point(int p, double depth) const { return camera_.unproject(p % width_ + 0.5, p / width_ + 0.5, depth); }

  /// What lies open between the solids of two pixels, or the step between two points of a surface.
  double gap(int p, int q) const {
    if (!closed_) return std::abs(front(p) - front(q));
    return std::max(front(p), front(q)) - std::min(back(p), back(q));
  }
  double step(int p, int q) const { return std::abs(front(p) - front(q)); }

  /// Gives every pixel a back that lies behind its front. @return how many had none
  long settle_back() {
    long missing = 0;
    if (!closed_) return 0;
    for (int y = 0; y < depth_.rows; ++y)
      for (int x = 0; x < depth_.cols; ++x) {
        const float z = depth_.at<float>(y, x);
        float& b = back_.at<float>(y, x);
        if (std::isnan(z)) continue;
        missing += !(b >= z);
        const float least = float(z + kLeastThickness * pixel_width(z));
        if (!(b >= least)) b = least;
      }
    return missing;
  }

 private:
  const Camera& camera_;
  const cv::Mat& depth_;
  cv::Mat back_;
  int width_;
  bool closed_;
};

void check_input(const cv::Mat& depth, const cv::Mat& back, const Camera& camera) {
  const auto pixels = [](const cv::Mat& m) { return std::to_string(m.cols) + " x " + std::to_string(m.rows); };
  if (!back.empty() && back.size() != depth.size())
    throw UserError("The back depth has " + pixels(back) + " pixels and the depth " + pixels(depth) +
                    "; give two rasters of one view.");
  double low = 0, high = 0;
  const cv::Mat mask = depth == depth;
  const int seen = cv::countNonZero(mask);
  if (seen > 0) cv::minMaxLoc(depth, &low, &high, nullptr, nullptr, mask);
  if (camera.focal > 0 && seen > 0 && !(low > 0))
    throw UserError(
        "Some depths are negative, where a pinhole camera sees nothing; change the sign of DepthScale, or "
        "set FocalLength to 0.");
  check_memory("A mesh of this depth raster", kBytesPerPixel * seen * (back.empty() ? 1 : 2), available_memory(),
               "make the raster smaller");
}

/// Turns faces between pixels into a mesh.
class Builder {
 public:
  Builder(const Solid& solid, const PixelFaces& faces, cv::Size size)
      : solid_(solid), faces_(faces), size_(size), front_(std::size_t(faces.pixels()), -1) {}

  /// A surface; where several fans meet in a pixel each gets a vertex.
  Mesh sheet() {
    split_fans();
    faces_.each([&](const PixelFaces::Face& f) {
      Triangle t;
      for (int k = 0; k < 3; ++k) t[k] = vertex_of(f, f[k]);
      add(t);
    });
    return finished();
  }

  Mesh solid(int& walls) {
    std::vector<int> back(front_.size(), -1);
    const auto vertex = [&](std::vector<int>& of, int p, double depth) {
      if (of[p] < 0) of[p] = new_vertex(p, depth);
      return of[p];
    };
    faces_.each([&](const PixelFaces::Face& f) {
      Triangle t;
      for (int k = 0; k < 3; ++k) t[k] = vertex(front_, f[k], solid_.front(f[k]));
      add(t);
    });
    faces_.each([&](const PixelFaces::Face& f) {
      Triangle t;
      for (int k = 0; k < 3; ++k) t[k] = vertex(back, f[2 - k], solid_.back(f[2 - k]));
      add(t);
    });
    const int before = mesh_.face_count();
    std::vector<int> first(front_.size(), -1);  // of the vertices between front and back
    faces_.each_border([&](int u, int v) { add_wall(column(u, back, first), column(v, back, first)); });
    walls = mesh_.face_count() - before;
    return finished();
  }

 private:
  int new_vertex(int pixel, double depth) {
    mesh_.vertices.push_back(solid_.point(pixel, depth));
    pixel_.push_back(pixel);
    return mesh_.vertex_count() - 1;
  }

  void add(const Triangle& t) {
    mesh_.faces.push_back(t);
    Wedges w;
    w.texture = 0;
    for (int k = 0; k < 3; ++k) {
      const int p = pixel_[t[k]];
      w.uv[k] = {float((p % size_.width + 0.5) / size_.width), float(1 - (p / size_.width + 0.5) / size_.height)};
    }
    mesh_.wedges.push_back(w);
  }

  /// More than one fan at a pixel: the others' vertices, by the side of a face that leaves the pixel.
  void split_fans() {
    std::vector<std::uint8_t> sides(front_.size(), 0);
    faces_.each_border([&](int u, int v) { ++sides[u], ++sides[v]; });
    for (int p = 0; p < faces_.pixels(); ++p) {
      if (sides[p] <= 2) continue;
      const auto fans = faces_.fans(p);
      for (std::size_t i = 1; i < fans.size(); ++i) {
        const int v = new_vertex(p, solid_.front(p));
        for (const PixelFaces::Corner& c : fans[i]) extra_.push_back({faces_.face(c.block, c.which), p, v});
      }
    }
    std::sort(extra_.begin(), extra_.end());
  }
  int vertex_of(const PixelFaces::Face& f, int p) {
    if (!extra_.empty()) {
      const auto at = std::lower_bound(extra_.begin(), extra_.end(), Extra{f, p, -1});
      if (at != extra_.end() && at->face == f && at->pixel == p) return at->vertex;
    }
    if (front_[p] < 0) front_[p] = new_vertex(p, solid_.front(p));
    return front_[p];
  }

  /// The vertices at a rim's pixel, from front to back.
  std::vector<int> column(int p, const std::vector<int>& back, std::vector<int>& first) {
    const double z = solid_.front(p), thickness = solid_.back(p) - z;
    const double steps = std::round(thickness / solid_.pixel_width(z));
    const int n = steps < 1 ? 1 : steps > kWallSteps ? kWallSteps : int(steps);
    if (n > 1 && first[p] < 0) {
      first[p] = mesh_.vertex_count();
      for (int i = 1; i < n; ++i) new_vertex(p, z + thickness * i / n);
    }
    std::vector<int> vertices = {front_[p]};
    for (int i = 1; i < n; ++i) vertices.push_back(first[p] + i - 1);
    vertices.push_back(back[p]);
    return vertices;
  }

  /// Between the columns at both ends of a side u -> v of the front.
  void add_wall(const std::vector<int>& u, const std::vector<int>& v) {
    std::size_t i = 0, j = 0;
    while (i + 1 < u.size() || j + 1 < v.size()) {
      const bool along_u =
          j + 1 >= v.size() || (i + 1 < u.size() && (i + 1) * (v.size() - 1) <= (j + 1) * (u.size() - 1));
      add(along_u ? Triangle{v[j], u[i], u[i + 1]} : Triangle{v[j], u[i], v[j + 1]});
      ++(along_u ? i : j);
    }
  }

  Mesh finished() {
    mesh::update_normals(mesh_);
    return std::move(mesh_);
  }

  struct Extra {
    PixelFaces::Face face;
    int pixel, vertex;
    bool operator<(const Extra& o) const { return face != o.face ? face < o.face : pixel < o.pixel; }
  };

  const Solid& solid_;
  const PixelFaces& faces_;
  cv::Size size_;
  std::vector<int> front_;  ///< vertex of each pixel
  std::vector<int> pixel_;  ///< of each vertex
  std::vector<Extra> extra_;
  Mesh mesh_;
};

}  // namespace

Camera raster_camera(cv::Size size, double pixel_size, double focal) {
  Camera camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.center = {size.width / 2., size.height / 2.};
  camera.focal = focal;
  camera.scale = 1 / pixel_size;
  return camera;
}

DepthMesh depth_to_mesh(const cv::Mat& depth, const cv::Mat& back, const Camera& camera,
                        const DepthMeshOptions& options, Progress& progress) {
  check_input(depth, back, camera);
  DepthMesh out;
  Solid solid(depth, back, camera);
  out.back_before = solid.settle_back();
  const int pixels = depth.rows * depth.cols;
  progress.stage("Finding depth jumps", 0, 40);
  out.max_jump = options.max_jump > 0 ? options.max_jump : automatic_jump(depth, camera);

  std::vector<char> at_tear(std::size_t(pixels), 0);
  int row = 0;
  const auto joined = [&](int p, int q) {
    if (p / depth.cols > row) row = p / depth.cols, progress.at(double(row) / depth.rows);
    if (!solid.has(p) || !solid.has(q)) return false;
    if (!(solid.gap(p, q) > out.max_jump)) return true;
    at_tear[p] = at_tear[q] = 1;
    return false;
  };
  PixelFaces faces(depth.cols, depth.rows, joined, [&](int p, int q) { return solid.step(p, q); });
  out.torn = long(std::count(at_tear.begin(), at_tear.end(), 1));
  out.dropped_faces = faces.drop_strips(at_tear);
  progress.stage("Building the mesh", 40, 90);
  progress.at(0);
  if (solid.closed()) out.dropped_faces += faces.drop_pinches();
  if (faces.count() == 0)
    throw UserError(
        "No three neighbouring pixels have depths that go together; check the depth raster, or give a "
        "larger MaxJump.");
  Builder builder(solid, faces, depth.size());
  out.mesh = solid.closed() ? builder.solid(out.walls) : builder.sheet();
  progress.stage("Building the mesh", 90, 100);
  progress.at(1);
  return out;
}

}  // namespace parts::render
