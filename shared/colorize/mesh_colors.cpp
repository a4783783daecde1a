// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/colorize/mesh_colors.h"

#include <algorithm>
#include <cmath>

#include "parts/base/parallel.h"
#include "parts/colorize/color_examples.h"
#include "parts/colorize/hidden_colors.h"
#include "parts/colorize/kept_colors.h"
#include "parts/mesh/attributes.h"
#include "parts/render/atlas.h"
#include "parts/render/surface_color.h"

namespace parts::colorize {
namespace {

using Vec3f = Eigen::Vector3f;

constexpr double kFinest = 1e12;            // pixels a face: the finest level of a texture
constexpr Color kNone{200, 200, 200, 255};  // where a mesh has no colour
constexpr float kClearlySeen = 0.1f;        // see ViewSheet::look(): below, hidden_colors take over

std::vector<Vec3f> normals_of(const Mesh& mesh) {
  Mesh m;
  m.vertices = mesh.vertices, m.faces = mesh.faces;
  mesh::update_normals(m);
  return m.vertex_normal;
}

/// Colours of the vertices: what views see, and completed by the model.
void color_vertices(const Mesh& posed, const examples::ClassModel& like, int threads, MeshColors& colors) {
  const std::vector<Vec3f> normals = colors.oriented ? normals_of(posed) : std::vector<Vec3f>();
  colors.vertex.assign(posed.vertices.size(), Vec3f(0.5f, 128 / 255.f, 128 / 255.f));
  std::vector<char> known(posed.vertices.size(), 0);
  parallel_for(posed.vertex_count(), threads, [&](long begin, long end) {
    for (long v = begin; v < end; ++v) {
      const Vec3 n = normals.empty() ? Vec3::Zero() : Vec3(normals[v].cast<double>());
      known[v] = colors.sheet.look(colors.planes, 0, posed.vertices[v], n, colors.vertex[v].data()) > kClearlySeen;
    }
  });
  double area = 0, seen = 0;
  for (int i = 0; i < posed.face_count(); ++i) {
    const Triangle& f = posed.faces[i];
    const double a = posed.area_vector(i).norm();
    if (!std::isfinite(a)) continue;
    area += a, seen += a * (known[f[0]] + known[f[1]] + known[f[2]]) / 3;
  }
  colors.seen = area > 0 ? seen / area : 0;
  Mesh there;
  there.faces = posed.faces;
  for (const Vec3& v : posed.vertices) there.vertices.push_back(v * like.size + like.center);
  colors.continued = complete_colors(there, known, like, colors.vertex, threads);
}

/// The others' colours are made to go with those that stay.
void match_kept(const Mesh& posed, int threads, MeshColors& colors) {
  std::vector<Vec3f> own(posed.vertices.size(), Vec3f::Zero());
  std::vector<char> kept(posed.vertices.size(), 0);
  for (int f = 0; f < posed.face_count(); ++f)
    for (int k = 0; k < 3 && colors.keep[f]; ++k) {
      const int v = posed.faces[f][k];
      own[v] = to_ycbcr(render::surface_color(posed, colors.textures, f, Vec3f::Unit(k), kFinest, kNone));
      kept[v] = 1;
    }
  colors.correction = corrections(posed.vertices, colors.vertex, own, kept, threads);
}

}  // namespace

void color_surface(const examples::ClassModel& query, const examples::ClassModel& like, int threads,
                   MeshColors& colors) {
  color_vertices(query.mesh, like, threads, colors);
  if (!colors.keep.empty()) {
    colors.textures = query.textures;
    match_kept(query.mesh, threads, colors);
  }
  colors.posed = query.mesh.vertices;
}

Vec3f MeshColors::at(const Mesh& mesh, int face, const Vec3f& b) const {
  if (!keep.empty() && keep[face]) return to_ycbcr(render::surface_color(mesh, textures, face, b, kFinest, kNone));
  const Triangle& t = mesh.faces[face];
  const Vec3 p = double(b[0]) * posed[t[0]] + double(b[1]) * posed[t[1]] + double(b[2]) * posed[t[2]];
  const Vec3 n =
      oriented ? Vec3((posed[t[1]] - posed[t[0]]).cross(posed[t[2]] - posed[t[0]]).normalized()) : Vec3::Zero();
  const Vec3f mean = b[0] * vertex[t[0]] + b[1] * vertex[t[1]] + b[2] * vertex[t[2]];
  Vec3f direct = mean;
  const float share = std::min(1.f, sheet.look(planes, 0, p, n, direct.data()) / kClearlySeen);
  Vec3f color = share * direct + (1 - share) * mean;
  if (!correction.empty()) color += b[0] * correction[t[0]] + b[1] * correction[t[1]] + b[2] * correction[t[2]];
  return color;
}

BakedTexture bake_texture(const Mesh& mesh, const std::vector<Wedges>& wedges, int size, const MeshColors& colors,
                          int threads) {
  const render::TexelMap map = render::map_texels(wedges, size);
  std::vector<cv::Mat> planes;
  for (int k = 0; k < 3; ++k) planes.push_back(cv::Mat::zeros(size, size, CV_32F));
  BakedTexture baked;
  baked.mask = cv::Mat::zeros(size, size, CV_8U);
  parallel_for(size, threads, [&](long begin, long end) {
    for (int y = int(begin); y < end; ++y)
      for (int x = 0; x < size; ++x) {
        const std::size_t at = std::size_t(y) * size + x;
        if (map.face[at] < 0) continue;
        const Vec3f color = colors.at(mesh, map.face[at], map.barycentric[at]);
        for (int k = 0; k < 3; ++k) planes[k].at<float>(y, x) = color[k];
        baked.mask.at<uchar>(y, x) = 255;
      }
  });
  baked.color = to_color(planes);
  return baked;
}

std::vector<Color> vertex_colors(const MeshColors& colors) {
  std::vector<cv::Mat> planes;
  const int n = int(colors.vertex.size());
  for (int k = 0; k < 3; ++k) {
    planes.emplace_back(std::max(n, 1), 1, CV_32F, cv::Scalar(0));
    for (int v = 0; v < n; ++v)
      planes.back().at<float>(v) = colors.vertex[v][k] + (colors.correction.empty() ? 0 : colors.correction[v][k]);
  }
  const cv::Mat bgr = to_color(planes);
  std::vector<Color> out(std::size_t(n), Color{});
  for (int v = 0; v < n; ++v) {
    const cv::Vec3b& c = bgr.at<cv::Vec3b>(v);
    out[v] = {c[2], c[1], c[0], 255};
  }
  return out;
}

}  // namespace parts::colorize
