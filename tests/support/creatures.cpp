// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "support/shapes.h"

namespace parts::test {
namespace {

/// Marching tetrahedra: each cell of a grid cut into six tetrahedra around its
/// diagonal, the same way in every cell, so that neighbours always match.
class Marcher {
 public:
  Marcher(const std::function<double(const Vec3&)>& field, const Box& box, int cells) : field_(field), box_(box) {
    const double size = box.sizes().maxCoeff() / cells;
    for (int k = 0; k < 3; ++k) n_[k] = std::max(1, int(std::ceil(box.sizes()[k] / size))) + 1;
    values_.resize(std::size_t(n_[0]) * n_[1] * n_[2]);
    for (int i = 0; i < int(values_.size()); ++i) {
      values_[i] = field(point(i));
      if (std::abs(values_[i]) < 1e-9 * size) values_[i] = 1e-9 * size;  // never on a corner
    }
  }

  Mesh mesh() {
    constexpr int kPaths[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};  // corners from 0 to 7
    for (int z = 0; z + 1 < n_[2]; ++z)
      for (int y = 0; y + 1 < n_[1]; ++y)
        for (int x = 0; x + 1 < n_[0]; ++x) {
          const auto corner = [&](int c) { return id(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)); };
          for (const auto& path : kPaths) tetrahedron({corner(0), corner(path[0]), corner(path[1]), corner(7)});
        }
    return std::move(mesh_);
  }

 private:
  int id(int x, int y, int z) const { return (z * n_[1] + y) * n_[0] + x; }
  Vec3 point(int i) const {
    const Vec3 at(i % n_[0], i / n_[0] % n_[1], i / n_[0] / n_[1]);
    return box_.min() + at.cwiseQuotient(Vec3(n_[0] - 1, n_[1] - 1, n_[2] - 1)).cwiseProduct(box_.sizes());
  }
  int crossing(int a, int b) {
    if (a > b) std::swap(a, b);
    const auto [it, added] = ids_.try_emplace(std::uint64_t(a) << 32 | unsigned(b), mesh_.vertex_count());
    if (added) {
      const double t = std::clamp(values_[a] / (values_[a] - values_[b]), 0.02, 0.98);
      mesh_.vertices.push_back(point(a) + t * (point(b) - point(a)));
    }
    return it->second;
  }
  void triangle(int a, int b, int c, const Vec3& inside) {  // facing away from a point inside
    const Vec3 &p = mesh_.vertices[a], &q = mesh_.vertices[b], &r = mesh_.vertices[c];
    if ((q - p).cross(r - p).dot(inside - p) > 0) std::swap(b, c);
    mesh_.faces.push_back({a, b, c});
  }
  void tetrahedron(const std::array<int, 4>& t) {
    std::vector<int> in, out;
    for (int i : t) (values_[i] < 0 ? in : out).push_back(i);
    if (in.size() == 1) {
      triangle(crossing(in[0], out[0]), crossing(in[0], out[1]), crossing(in[0], out[2]), point(in[0]));
    } else if (in.size() == 3) {
      triangle(crossing(in[0], out[0]), crossing(in[1], out[0]), crossing(in[2], out[0]), point(in[0]));
    } else if (in.size() == 2) {
      const int a = crossing(in[0], out[0]), b = crossing(in[0], out[1]);
      const int c = crossing(in[1], out[1]), d = crossing(in[1], out[0]);
      const Vec3 inside = (point(in[0]) + point(in[1])) / 2;
      triangle(a, b, c, inside);
      triangle(a, c, d, inside);
    }
  }

  const std::function<double(const Vec3&)>& field_;
  Box box_;
  int n_[3];
  std::vector<double> values_;
  Mesh mesh_;
  std::unordered_map<std::uint64_t, int> ids_;
};

/// Moves vertices to their neighbours' mean and back onto the surface.
void relax(Mesh& mesh, const std::function<double(const Vec3&)>& field, double step) {
  std::vector<Vec3> sum(mesh.vertices.size(), Vec3::Zero());
  std::vector<int> count(mesh.vertices.size(), 0);
  for (const Triangle& f : mesh.faces)
    for (int k = 0; k < 3; ++k) sum[f[k]] += mesh.vertices[f[(k + 1) % 3]], ++count[f[k]];
  for (std::size_t v = 0; v < sum.size(); ++v) {
    Vec3 p = 0.4 * mesh.vertices[v] + 0.6 * sum[v] / count[v];
    const double value = field(p);
    Vec3 gradient;
    for (int k = 0; k < 3; ++k) gradient[k] = (field(p + step * Vec3::Unit(k)) - value) / step;
    const double slope = gradient.squaredNorm();
    if (slope > 0.01) p -= gradient * std::clamp(value / slope, -10 * step, 10 * step);
    mesh.vertices[v] = p;
  }
}

/// Signed distance to the hull of two balls (exact outside): the least, over the
/// balls between them, of the distance to the ball.
double distance(const Limb& l, const Vec3& p) {
  const Vec3 axis = l.to.center - l.from.center;
  const double length = axis.norm(), grow = l.to.radius - l.from.radius;
  if (length <= std::abs(grow)) {  // one ball holds the other
    const Ball& larger = grow > 0 ? l.to : l.from;
    return (p - larger.center).norm() - larger.radius;
  }
  const double slope = grow / length, along = (p - l.from.center).dot(axis) / length;
  const double away = (p - l.from.center - along / length * axis).norm();
  const double t = std::clamp((along + away * slope / std::sqrt(1 - slope * slope)) / length, 0., 1.);
  return (p - l.from.center - t * axis).norm() - l.from.radius - t * grow;
}

/// Each limb on both sides of the plane x = 0.
std::vector<Limb> mirrored(const std::vector<Limb>& limbs) {
  std::vector<Limb> both;
  for (Limb l : limbs) {
    both.push_back(l);
    l.from.center.x() *= -1, l.to.center.x() *= -1;
    both.push_back(l);
  }
  return both;
}

std::vector<Limb> operator+(std::vector<Limb> a, const std::vector<Limb>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

Mesh isosurface(const std::function<double(const Vec3&)>& field, const Box& box, int cells) {
  Mesh mesh = Marcher(field, box, cells).mesh();
  for (int i = 0; i < 3; ++i) relax(mesh, field, box.sizes().maxCoeff() / cells * 0.05);
  return mesh;
}

Mesh blend(const std::vector<Limb>& limbs, double softness, int cells) {
  Box box;
  for (const Limb& l : limbs)
    for (const Ball& b : {l.from, l.to})
      for (int k = 0; k < 3; ++k)
        box.extend(Vec3(b.center + b.radius * Vec3::Unit(k))).extend(Vec3(b.center - b.radius * Vec3::Unit(k)));
  const double margin = 2 * softness + 2 * box.sizes().maxCoeff() / cells;
  box.extend(Vec3(box.min() - Vec3::Constant(margin))).extend(Vec3(box.max() + Vec3::Constant(margin)));
  const auto field = [&](const Vec3& p) {
    double nearest = 1e9, sum = 0;
    double d[64];
    const int n = std::min(64, int(limbs.size()));
    for (int i = 0; i < n; ++i) nearest = std::min(nearest, d[i] = distance(limbs[i], p));
    for (int i = 0; i < n; ++i)
      if (d[i] - nearest < 20 * softness) sum += std::exp((nearest - d[i]) / softness);
    return nearest - softness * std::log(sum);
  };
  return isosurface(field, box, cells);
}

Mesh animal(int cells) {
  const std::vector<Limb> middle{
      {{{0, 0.62, -0.42}, 0.2}, {{0, 0.64, 0.35}, 0.19}},    // body
      {{{0, 0.72, 0.45}, 0.13}, {{0, 1.05, 0.68}, 0.1}},     // neck
      {{{0, 1.1, 0.7}, 0.12}, {{0, 0.98, 0.97}, 0.07}},      // head
      {{{0, 0.72, -0.58}, 0.06}, {{0, 0.45, -0.85}, 0.045}}  // tail
  };
  const std::vector<Limb> sides = mirrored({
      {{{0.13, 0.5, 0.38}, 0.09}, {{0.14, 0.08, 0.4}, 0.05}},
      {{{0.13, 0.5, -0.42}, 0.1}, {{0.14, 0.08, -0.46}, 0.05}},
      {{{0.06, 1.15, 0.66}, 0.05}, {{0.1, 1.28, 0.62}, 0.035}},  // ears
  });
  return blend(middle + sides, 0.03, cells);
}

Mesh man(int cells) {
  const std::vector<Limb> middle{
      {{{0, 0.85, 0}, 0.14}, {{0, 1.2, 0}, 0.17}},
      {{{0, 1.3, 0}, 0.07}, {{0, 1.48, 0.01}, 0.06}},
      {{{0, 1.58, 0.02}, 0.12}, {{0, 1.66, 0}, 0.12}},
      {{{0, 1.57, 0.13}, 0.02}, {{0, 1.53, 0.15}, 0.025}},  // nose
  };
  const std::vector<Limb> sides = mirrored({
      {{{0.16, 1.28, 0}, 0.08}, {{0.42, 1.05, 0}, 0.055}},
      {{{0.42, 1.05, 0}, 0.05}, {{0.58, 0.85, 0.16}, 0.045}},
      {{{0.09, 0.75, 0}, 0.1}, {{0.13, 0.08, 0}, 0.06}},
      {{{0.13, 0.07, 0}, 0.055}, {{0.14, 0.06, 0.14}, 0.045}},
  });
  return blend(middle + sides, 0.025, cells);
}

Mesh bust(unsigned seed, int cells) {
  Random random(seed);
  const auto about = [&](double x) { return x * random.uniform(0.88, 1.12); };
  const double jaw = about(0.2), brow = about(0.27), nose = about(0.1);
  const std::vector<Limb> middle{
      {{{0, 0.55, 0.02}, jaw}, {{0, 0.8, -0.03}, brow}},
      {{{0, 0.2, -0.04}, about(0.14)}, {{0, 0.5, -0.04}, about(0.13)}},
      {{{0, 0.68, jaw + 0.03}, 0.02}, {{0, 0.58, jaw + nose}, 0.035}},
      {{{0, 0.38, jaw * 0.7}, 0.05}, {{0, 0.4, jaw * 0.9}, 0.05}},  // chin
  };
  const std::vector<Limb> sides = mirrored({
      {{{0.05, 0.12, -0.04}, 0.15}, {{about(0.42), 0.0, -0.04}, 0.13}},
      {{{brow, 0.68, -0.02}, 0.03}, {{brow, 0.58, -0.02}, 0.025}},
      {{{0.1, 0.52, jaw * 0.75}, about(0.06)}, {{0.12, 0.55, jaw * 0.6}, 0.06}},
  });
  return blend(middle + sides, 0.03, cells);
}

Mesh bush(unsigned seed, int cells) {
  Random random(seed);
  std::vector<Limb> limbs{{{{0, 0, 0}, 0.5}, {{0, 0, 0}, 0.5}}};
  for (int i = 0; i < 36; ++i) {
    const Ball ball{random.direction() * random.uniform(0.45, 0.65), random.uniform(0.13, 0.2)};
    limbs.push_back({ball, ball});
  }
  return blend(limbs, 0.05, cells);
}

Mesh glasses(int cells) {
  constexpr int kParts = 24;
  std::vector<Limb> half;
  for (int i = 0; i < kParts; ++i) {
    const auto rim = [&](int k) {
      const double u = 2 * 3.14159265358979323846 * k / kParts;
      return Ball{{0.22 + 0.16 * std::cos(u), 0.14 * std::sin(u), 0}, 0.022};
    };
    half.push_back({rim(i), rim(i + 1)});
  }
  half.push_back({{{0.06, 0.03, 0}, 0.022}, {{0, 0.05, 0.01}, 0.022}});
  half.push_back({{{0.38, 0.03, 0}, 0.022}, {{0.4, 0.03, -0.45}, 0.018}});
  half.push_back({{{0.4, 0.03, -0.45}, 0.018}, {{0.39, -0.06, -0.55}, 0.018}});
  return blend(mirrored(half), 0.002, cells);
}

Mesh hat(int around) {
  const std::vector<Eigen::Vector2d> profile{{0, 0.38},   {0.12, 0.39}, {0.24, 0.4},   {0.3, 0.42},  {0.33, 0.2},
                                             {0.34, 0.1}, {0.35, 0.04}, {0.5, 0.01},   {0.62, 0.02}, {0.62, 0.05},
                                             {0.5, 0.04}, {0.39, 0.07}, {0.375, 0.11}, {0.365, 0.2}, {0.335, 0.45},
                                             {0.3, 0.47}, {0.24, 0.45}, {0.12, 0.44},  {0, 0.43}};
  const Mesh upright = lathe(profile, around);  // along z; the suite's creatures stand along y
  return moved(upright, Eigen::Affine3d(Eigen::AngleAxisd(-3.14159265358979323846 / 2, Vec3::UnitX())));
}

}  // namespace parts::test
