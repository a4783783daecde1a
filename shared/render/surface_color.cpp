// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/surface_color.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "parts/io/raster_io.h"
#include "parts/render/rasterize.h"

namespace parts::render {

Textures load_textures(const Mesh& mesh) {
  Textures textures;
  for (const std::string& file : mesh.textures) {
    std::vector<cv::Mat> levels;
    cv::Mat image;
    try {
      image = io::read_texture(file);
    } catch (const UserError&) {  // as if there were none
    }
    while (!image.empty()) {
      levels.push_back(image);
      if (image.cols < 2 || image.rows < 2) break;
      cv::resize(image, image, cv::Size(image.cols / 2, image.rows / 2), 0, 0, cv::INTER_AREA);
    }
    textures.images.push_back(levels);
  }
  return textures;
}

namespace {

using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;

/// Bilinear; the image repeats and its first row is at v = 1.
Vec3f sample(const cv::Mat& image, const Vec2f& uv) {
  const auto wrapped = [](float x) { return std::isfinite(x) ? x - std::floor(x) : 0.f; };
  const float x = wrapped(uv.x()) * float(image.cols) - 0.5f, y = wrapped(1 - uv.y()) * float(image.rows) - 0.5f;
  const int column = int(std::floor(x)), row = int(std::floor(y));
  const float fx = x - float(column), fy = y - float(row);
  const auto texel = [&](int c, int r) {
    c = (c + image.cols) % image.cols, r = (r + image.rows) % image.rows;
    const std::uint8_t* t = image.ptr<std::uint8_t>(r) + 3 * c;
    return Vec3f(t[0], t[1], t[2]);
  };
  return (1 - fy) * ((1 - fx) * texel(column, row) + fx * texel(column + 1, row)) +
         fy * ((1 - fx) * texel(column, row + 1) + fx * texel(column + 1, row + 1));
}

/// From the level whose texels are about as large as the pixels.
Vec3f textured(const std::vector<cv::Mat>& levels, const std::array<Vec2f, 3>& uv, const Vec3f& w, double pixels) {
  const Vec2f u = uv[1] - uv[0], v = uv[2] - uv[0];
  const double texels = std::abs(double(u.x()) * v.y() - double(u.y()) * v.x()) * levels[0].cols * levels[0].rows;
  const double level = texels > pixels ? std::log2(texels / pixels) / 2 : 0;
  const int l = std::isfinite(level) ? std::min(int(level + 0.5), int(levels.size()) - 1) : 0;
  return sample(levels[l], w[0] * uv[0] + w[1] * uv[1] + w[2] * uv[2]);
}

/// The images of a face, fine to coarse; null where it has none.
const std::vector<cv::Mat>* images_of(const Mesh& mesh, const Textures& textures, int face) {
  if (mesh.wedges.empty()) return nullptr;
  const int texture = mesh.wedges[face].texture;
  if (texture < 0 || texture >= int(textures.images.size()) || textures.images[texture].empty()) return nullptr;
  return &textures.images[texture];
}

}  // namespace

Vec3f bgr(const Color& c) { return {float(c[2]), float(c[1]), float(c[0])}; }

Vec3f surface_color(const Mesh& mesh, const Textures& textures, int face, const Vec3f& w, double pixels,
                    const Color& base) {
  if (const auto* levels = images_of(mesh, textures, face)) return textured(*levels, mesh.wedges[face].uv, w, pixels);
  const Triangle& t = mesh.faces[face];
  const auto& vc = mesh.vertex_color;
  if (!vc.empty()) return w[0] * bgr(vc[t[0]]) + w[1] * bgr(vc[t[1]]) + w[2] * bgr(vc[t[2]]);
  return bgr(mesh.face_color.empty() ? base : mesh.face_color[face]);
}

bool has_colors(const Mesh& mesh, const Textures& textures) {
  if (!mesh.vertex_color.empty() || !mesh.face_color.empty()) return true;
  for (int f = 0; f < mesh.face_count(); ++f)
    if (images_of(mesh, textures, f)) return true;
  return false;
}

}  // namespace parts::render
