// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/rasterize.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "parts/base/parallel.h"
#include "parts/render/shade.h"

namespace parts::render {
namespace {

/// Rounds to 1/4096 pixel. Then the edge functions below are exact in images
/// of up to 8192 pixels, and neighbours neither overlap nor leave gaps.
double snap(double x) {
  constexpr double magic = 1.5 * (1ll << 40);
  return (x + magic) - magic;
}

std::vector<ScreenPoint> project(const Mesh& mesh, const Camera& camera, int threads) {
  std::vector<ScreenPoint> points(mesh.vertices.size());
  parallel_for(long(points.size()), threads, [&](long begin, long end) {
    for (long v = begin; v < end; ++v) {
      const Vec3 p = camera.project(mesh.vertices[v]);
      const bool seen =
          std::abs(p.x()) < 1e9 && std::abs(p.y()) < 1e9 && std::isfinite(p.z()) && (camera.focal <= 0 || p.z() > 0);
      points[v] = seen ? ScreenPoint{snap(p.x()), snap(p.y()), p.z()}
                       : ScreenPoint{std::numeric_limits<double>::quiet_NaN(), 0, 0};
    }
  });
  return points;
}

/// Draws depths and face indices into some rows of a rendering.
class DepthBand {
 public:
  DepthBand(Rendering& out, bool perspective, int first_row, int end_row)
      : out_(out), perspective_(perspective), first_row_(first_row), end_row_(end_row) {}

  void draw(int face, const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c) {
    const double low = std::min({a.y, b.y, c.y}), high = std::max({a.y, b.y, c.y});
    if (high < first_row_ || low > end_row_) return;
    const double left = std::min({a.x, b.x, c.x}), right = std::max({a.x, b.x, c.x});
    if (!(left + right < 1e12) || std::isnan(a.x + b.x + c.x)) return;
    const int y0 = first_center(low, first_row_), y1 = last_center(high, end_row_ - 1);
    const int x0 = first_center(left, 0), x1 = last_center(right, out_.depth.cols - 1);
    if (y0 > y1 || x0 > x1) return;
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area > 0)
      fill(face, a, b, c, area, x0, x1, y0, y1);
    else if (area < 0)
      fill(face, a, c, b, -area, x0, x1, y0, y1);
  }

 private:
  static int first_center(double low, int least) { return int(std::ceil(std::max(low - 0.5, double(least)))); }
  static int last_center(double high, int most) { return int(std::floor(std::min(high - 0.5, double(most)))); }

  /// The side p -> q of a triangle that is clockwise on the screen: positive
  /// inside; a pixel on it belongs to it if it is a top or left side.
  struct Side {
    double dx, dy, at;  // change a column and a row, value at the first pixel
    bool inclusive;
    Side(const ScreenPoint& p, const ScreenPoint& q, double x, double y)
        : dx(p.y - q.y), dy(q.x - p.x), at(dy * (y - p.y) + dx * (x - p.x)), inclusive(dx > 0 || (dx == 0 && dy > 0)) {}
    bool inside(double w) const { return w > 0 || (w == 0 && inclusive); }
  };

  void fill(int face, const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c, double area, int x0, int x1,
            int y0, int y1) {
    const double x = x0 + 0.5, y = y0 + 0.5;
    Side sa(b, c, x, y), sb(c, a, x, y), sc(a, b, x, y);
    const double za = key(a.z) / area, zb = key(b.z) / area, zc = key(c.z) / area;
    for (int row = y0; row <= y1; ++row) {
      float* depth = out_.depth.ptr<float>(row);
      float* back = out_.back_depth.ptr<float>(row);
      int* index = out_.face.ptr<int>(row);
      double wa = sa.at, wb = sb.at, wc = sc.at;
      for (int column = x0; column <= x1; ++column, wa += sa.dx, wb += sb.dx, wc += sc.dx) {
        if (!(sa.inside(wa) && sb.inside(wb) && sc.inside(wc))) continue;
        const float z = float(key(wa * za + wb * zb + wc * zc));
        if (index[column] < 0) {
          depth[column] = back[column] = z;
          index[column] = face;
        } else if (z < depth[column]) {
          depth[column] = z;
          index[column] = face;
        } else if (z > back[column]) {
          back[column] = z;
        }
      }
      sa.at += sa.dy, sb.at += sb.dy, sc.at += sc.dy;
    }
  }
  /// What is linear on the screen: depth, or its inverse in a pinhole image.
  double key(double z) const { return perspective_ ? 1 / z : z; }

  Rendering& out_;
  bool perspective_;
  int first_row_, end_row_;
};

}  // namespace

Rendering render(const Mesh& mesh, const Textures& textures, const Camera& camera, const RenderOptions& options) {
  const cv::Size size(camera.width, camera.height);
  Rendering out;
  out.depth = cv::Mat(size, CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  out.back_depth = out.depth.clone();
  out.face = cv::Mat(size, CV_32S, cv::Scalar(-1));
  const std::vector<ScreenPoint> points = project(mesh, camera, options.threads);
  parallel_for(camera.height, options.threads, [&](long begin, long end) {
    DepthBand band(out, camera.focal > 0, int(begin), int(end));
    for (int f = 0; f < mesh.face_count(); ++f) {
      const Triangle& t = mesh.faces[f];
      band.draw(f, points[t[0]], points[t[1]], points[t[2]]);
    }
  });
  out.mask = cv::Mat(size, CV_8U, cv::Scalar(0));
  if (!out.face.empty()) cv::compare(out.face, 0, out.mask, cv::CMP_GE);
  shade(mesh, textures, camera, options, points, out);
  return out;
}

}  // namespace parts::render
