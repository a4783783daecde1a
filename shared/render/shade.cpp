// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shade.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/parallel.h"

namespace parts {

Textures load_textures(const Mesh& mesh) {
  Textures textures;
  for (const std::string& file : mesh.textures) {
    std::vector<cv::Mat> levels;
    cv::Mat image;
    std::error_code error;
    try {
      if (std::filesystem::is_regular_file(file, error)) image = cv::imread(file, cv::IMREAD_COLOR);
    } catch (const cv::Exception&) {  // larger than OpenCV reads
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

Vec3f bgr(const Color& c) { return {float(c[2]), float(c[1]), float(c[0])}; }

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

Vec3f face_normal(const Mesh& mesh, int f) {
  const Vec3& a = mesh.corner(f, 0);
  return (mesh.corner(f, 1) - a).cross(mesh.corner(f, 2) - a).normalized().cast<float>();
}

/// Mean normals (by area) of the vertices of visible faces; few of a fine mesh.
std::vector<Vec3f> normals_of_visible(const Mesh& mesh, const cv::Mat& face) {
  std::vector<char> visible(mesh.vertices.size(), 0);
  for (int y = 0; y < face.rows; ++y)
    for (int x = 0; x < face.cols; ++x)
      if (const int f = face.at<int>(y, x); f >= 0)
        for (int v : mesh.faces[f]) visible[v] = 1;
  std::vector<Vec3f> normals(mesh.vertices.size(), Vec3f::Zero());
  std::vector<Vec3> sum;  // too small faces for floats
  std::vector<int> place(mesh.vertices.size(), -1);
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Triangle& t = mesh.faces[f];
    if (!(visible[t[0]] | visible[t[1]] | visible[t[2]])) continue;
    const Vec3& a = mesh.vertices[t[0]];
    const Vec3 n = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
    if (!n.allFinite()) continue;
    for (int v : t) {
      if (!visible[v]) continue;
      if (place[v] < 0) place[v] = int(sum.size()), sum.push_back(Vec3::Zero());
      sum[place[v]] += n;
    }
  }
  for (std::size_t v = 0; v < normals.size(); ++v)
    if (place[v] >= 0) normals[v] = sum[place[v]].normalized().cast<float>();
  return normals;
}

/// Light and colour at points of faces.
class Shader {
 public:
  Shader(const Mesh& mesh, const Textures& textures, const Camera& camera, const RenderOptions& options,
         const std::vector<ScreenPoint>& points, const std::vector<Vec3f>& normals)
      : mesh_(mesh),
        textures_(textures),
        options_(options),
        points_(points),
        normals_(normals),
        rotation_(camera.rotation.cast<float>()),
        light_(light_of(options)),
        perspective_(camera.focal > 0) {}

  Vec3f at(int face, double x, double y) const {
    const Triangle& t = mesh_.faces[face];
    const ScreenPoint &a = points_[t[0]], &b = points_[t[1]], &c = points_[t[2]];
    const double area = cross(a, b, c.x, c.y);
    const double wa = cross(b, c, x, y) / area, wb = cross(c, a, x, y) / area, wc = cross(a, b, x, y) / area;
    const bool front = area < 0;  // counter-clockwise, but y runs down
    Vec3f w = Vec3f(float(wa), float(wb), float(wc));
    if (perspective_) w = w.cwiseQuotient(Vec3f(float(a.z), float(b.z), float(c.z)));
    w /= w.sum();
    Vec3f color = color_of(face, w, std::abs(area));
    if (options_.mark_back_faces && !front) color = 0.3f * color + 0.7f * Vec3f(60, 60, 200);
    if (options_.edge_width > 0) color *= 1 - 0.65f * edge(a, b, c, std::abs(area), wa, wb, wc);
    return color * light(normal_of(face, w, front));
  }

 private:
  static Vec3f light_of(const RenderOptions& options) {
    const double length = options.light.norm();
    return length > 0 && std::isfinite(length) ? Vec3f((options.light / length).cast<float>()) : Vec3f(0, 0, 1);
  }
  static double cross(const ScreenPoint& p, const ScreenPoint& q, double x, double y) {
    return (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
  }

  Vec3f normal_of(int face, const Vec3f& w, bool front) const {
    const Triangle& t = mesh_.faces[face];
    Vec3f n = Vec3f::Zero();
    if (!normals_.empty()) n = w[0] * normals_[t[0]] + w[1] * normals_[t[1]] + w[2] * normals_[t[2]];
    if (!(n.squaredNorm() > 1e-12f)) n = face_normal(mesh_, face);
    n = (rotation_ * n).normalized();
    return front ? n : Vec3f(-n);
  }

  float light(const Vec3f& n) const {
    const float ambient = float(options_.ambient), sky = float(options_.sky), rim = float(options_.rim);
    const float diffuse = (1 - ambient) * std::max(0.f, n.dot(light_));
    const float slant = 1 - std::clamp(n.z(), 0.f, 1.f);
    return (ambient * (1 - sky * 0.5f * (1 - n.y())) + diffuse) * (1 - rim * slant * slant);
  }

  Vec3f color_of(int face, const Vec3f& w, double screen_area) const {
    if (!options_.colors) return bgr(options_.base);
    if (!mesh_.wedges.empty()) {
      const Wedges& wedges = mesh_.wedges[face];
      if (wedges.texture >= 0 && wedges.texture < int(textures_.images.size()))
        if (const auto& levels = textures_.images[wedges.texture]; !levels.empty())
          return textured(levels, wedges.uv, w, screen_area);
    }
    const Triangle& t = mesh_.faces[face];
    const auto& vc = mesh_.vertex_color;
    if (!vc.empty()) return w[0] * bgr(vc[t[0]]) + w[1] * bgr(vc[t[1]]) + w[2] * bgr(vc[t[2]]);
    return bgr(mesh_.face_color.empty() ? options_.base : mesh_.face_color[face]);
  }

  /// From the level whose texels are about as large as the pixels.
  static Vec3f textured(const std::vector<cv::Mat>& levels, const std::array<Vec2f, 3>& uv, const Vec3f& w,
                        double screen_area) {
    const Vec2f u = uv[1] - uv[0], v = uv[2] - uv[0];
    const double texels = std::abs(double(u.x()) * v.y() - double(u.y()) * v.x()) * levels[0].cols * levels[0].rows;
    const double level = texels > screen_area ? std::log2(texels / screen_area) / 2 : 0;
    const int l = std::isfinite(level) ? std::min(int(level + 0.5), int(levels.size()) - 1) : 0;
    return sample(levels[l], w[0] * uv[0] + w[1] * uv[1] + w[2] * uv[2]);
  }

  /// 1 on the face's sides, 0 where they are farther than half a line's width.
  float edge(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c, double area, double wa, double wb,
             double wc) const {
    const auto length = [](const ScreenPoint& p, const ScreenPoint& q) { return std::hypot(p.x - q.x, p.y - q.y); };
    const double distance = std::min({wa * area / length(b, c), wb * area / length(c, a), wc * area / length(a, b)});
    return float(std::clamp(options_.edge_width / 2 + 0.5 - distance, 0., 1.));
  }

  const Mesh& mesh_;
  const Textures& textures_;
  const RenderOptions& options_;
  const std::vector<ScreenPoint>& points_;
  const std::vector<Vec3f>& normals_;
  const Eigen::Matrix3f rotation_;
  const Vec3f light_;
  const bool perspective_;
};

}  // namespace

void shade(const Mesh& mesh, const Textures& textures, const Camera& camera, const RenderOptions& options,
           const std::vector<ScreenPoint>& points, Rendering& out) {
  const Vec3f background = bgr(options.background);
  out.image = cv::Mat(out.face.size(), CV_8UC3, cv::Scalar(background[0], background[1], background[2]));
  std::vector<Vec3f> means;
  const bool own = mesh.vertex_normal.size() == mesh.vertices.size();
  if (options.smooth && !own) means = normals_of_visible(mesh, out.face);
  const Shader shader(mesh, textures, camera, options, points, options.smooth && own ? mesh.vertex_normal : means);
  parallel_for(out.face.rows, options.threads, [&](long begin, long end) {
    for (int y = int(begin); y < int(end); ++y) {
      const int* face = out.face.ptr<int>(y);
      std::uint8_t* pixel = out.image.ptr<std::uint8_t>(y);
      for (int x = 0; x < out.face.cols; ++x, pixel += 3) {
        if (face[x] < 0) continue;
        const Vec3f color = shader.at(face[x], x + 0.5, y + 0.5);
        for (int k = 0; k < 3; ++k) pixel[k] = std::uint8_t(std::clamp(color[k] + 0.5f, 0.f, 255.f));
      }
    }
  });
}

}  // namespace parts
