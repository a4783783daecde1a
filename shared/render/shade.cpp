// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/shade.h"

#include <algorithm>
#include <cmath>

#include "parts/base/parallel.h"
#include "parts/render/surface_color.h"

namespace parts::render {

namespace {

using Vec3f = Eigen::Vector3f;

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
    const Vec3 n = mesh.area_vector(f);
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
    Vec3f color =
        options_.colors ? surface_color(mesh_, textures_, face, w, std::abs(area), options_.base) : bgr(options_.base);
    if (options_.mark_back_faces && !front) color = 0.3f * color + 0.7f * Vec3f(60, 60, 200);
    if (options_.edge_width > 0) color *= 1 - 0.65f * edge(a, b, c, std::abs(area), wa, wb, wc);
    return color * light(normal_of(face, w, front));
  }

 private:
  static Vec3f light_of(const RenderOptions& options) {
    const double length = options.light.direction.norm();
    return length > 0 && std::isfinite(length) ? Vec3f((options.light.direction / length).cast<float>())
                                               : Vec3f(0, 0, 1);
  }
  static double cross(const ScreenPoint& p, const ScreenPoint& q, double x, double y) {
    return (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
  }

  Vec3f normal_of(int face, const Vec3f& w, bool front) const {
    const Triangle& t = mesh_.faces[face];
    Vec3f n = Vec3f::Zero();
    if (!normals_.empty()) n = w[0] * normals_[t[0]] + w[1] * normals_[t[1]] + w[2] * normals_[t[2]];
    if (!(n.squaredNorm() > 1e-12f)) n = mesh_.normal(face).cast<float>();
    n = (rotation_ * n).normalized();
    return front ? n : Vec3f(-n);
  }

  float light(const Vec3f& n) const {
    const float ambient = float(options_.light.ambient), sky = float(options_.sky), rim = float(options_.rim);
    const float diffuse = (1 - ambient) * std::max(0.f, n.dot(light_));
    const float slant = 1 - std::clamp(n.z(), 0.f, 1.f);
    return (ambient * (1 - sky * 0.5f * (1 - n.y())) + diffuse) * (1 - rim * slant * slant);
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

}  // namespace parts::render
