// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace parts::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// The vertex between two others, made once.
class Midpoints {
 public:
  explicit Midpoints(Mesh& mesh) : mesh_(mesh) {}
  int of(int a, int b) {
    const auto [it, added] = ids_.try_emplace(std::minmax(a, b), mesh_.vertex_count());
    if (added) mesh_.vertices.push_back((mesh_.vertices[a] + mesh_.vertices[b]) / 2);
    return it->second;
  }

 private:
  Mesh& mesh_;
  std::map<std::pair<int, int>, int> ids_;
};

void subdivide(Mesh& mesh) {
  Midpoints middle(mesh);
  std::vector<Triangle> faces;
  for (const Triangle& f : mesh.faces) {
    const int a = middle.of(f[0], f[1]), b = middle.of(f[1], f[2]), c = middle.of(f[2], f[0]);
    for (const Triangle& t : {Triangle{f[0], a, c}, {f[1], b, a}, {f[2], c, b}, {a, b, c}}) faces.push_back(t);
  }
  mesh.faces = std::move(faces);
}

void add_quad(Mesh& mesh, int a, int b, int c, int d) {
  mesh.faces.push_back({a, b, c});
  mesh.faces.push_back({a, c, d});
}

}  // namespace

Mesh box(const Vec3& min, const Vec3& max, int divisions) {
  Mesh mesh;
  std::map<std::array<int, 3>, int> ids;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [it, added] = ids.try_emplace(at, mesh.vertex_count());
    if (added) {
      const Vec3 share = Vec3(at[0], at[1], at[2]) / divisions;
      mesh.vertices.push_back(min + (max - min).cwiseProduct(share));
    }
    return it->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < divisions; ++i)
        for (int j = 0; j < divisions; ++j) {
          const auto at = [&](int u, int v) {
            std::array<int, 3> p;
            p[axis] = side * divisions, p[(axis + 1) % 3] = u, p[(axis + 2) % 3] = v;
            return vertex(p);
          };
          const int a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
          side ? add_quad(mesh, a, b, c, d) : add_quad(mesh, a, d, c, b);
        }
  return mesh;
}

Mesh sphere(const Vec3& center, double radius, int subdivisions) {
  const double g = (1 + std::sqrt(5.)) / 2;
  Mesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vec3& p : mesh.vertices) p.normalize();
  for (int i = 0; i < subdivisions; ++i) {
    subdivide(mesh);
    for (Vec3& p : mesh.vertices) p.normalize();
  }
  for (Vec3& p : mesh.vertices) p = center + radius * p;
  return mesh;
}

Mesh noisy_sphere(const Vec3& center, double radius, int subdivisions, double amplitude, unsigned seed) {
  Random random(seed);
  struct Wave {
    Vec3 direction;
    double phase;
  };
  std::vector<Wave> waves;
  for (int i = 0; i < 12; ++i) waves.push_back({random.direction() * random.uniform(2, 7), random.uniform(0, 2 * kPi)});
  Mesh mesh = sphere(Vec3::Zero(), 1, subdivisions);
  for (Vec3& p : mesh.vertices) {
    double sum = 0;
    for (const Wave& w : waves) sum += std::sin(w.direction.dot(p) + w.phase);
    p = center + p * radius * (1 + amplitude * sum / double(waves.size()));
  }
  return mesh;
}

Mesh torus(const Vec3& center, double radius, double tube, int around, int across) {
  Mesh mesh;
  const auto vertex = [&](int i, int j) { return i % around * across + j % across; };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * kPi * i / around, v = 2 * kPi * j / across, r = radius + tube * std::cos(v);
      mesh.vertices.push_back(center + Vec3(r * std::cos(u), r * std::sin(u), tube * std::sin(v)));
      add_quad(mesh, vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1));
    }
  return mesh;
}

namespace {

/// Joins rings of vertices, each `around` long, and closes both ends at points.
Mesh rings_to_mesh(const std::vector<std::vector<Vec3>>& rings, const Vec3& first, const Vec3& last) {
  Mesh mesh;
  const int around = int(rings[0].size()), n = int(rings.size());
  for (const auto& ring : rings) mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
  mesh.vertices.push_back(first);
  mesh.vertices.push_back(last);
  for (int j = 0; j < around; ++j) {
    const int k = (j + 1) % around;
    mesh.faces.push_back({n * around, k, j});
    for (int i = 0; i + 1 < n; ++i)
      add_quad(mesh, i * around + j, i * around + k, (i + 1) * around + k, (i + 1) * around + j);
    mesh.faces.push_back({n * around + 1, (n - 1) * around + j, (n - 1) * around + k});
  }
  return mesh;
}

}  // namespace

Mesh tube(const std::vector<Ball>& path, int around) {
  std::vector<std::vector<Vec3>> rings;
  Vec3 side = Vec3::Zero();
  const int n = int(path.size()), cap = std::max(2, around / 4);
  const auto along = [&](int i) {
    return Vec3((path[std::min(i + 1, n - 1)].center - path[std::max(i - 1, 0)].center).normalized());
  };
  const auto add_ring = [&](int i, double angle) {  // +-90 degrees are the round ends' tips
    const Vec3 t = along(i);
    if (side.isZero()) side = t.unitOrthogonal();
    side = (side - side.dot(t) * t).normalized();
    const Vec3 up = t.cross(side), center = path[i].center + t * path[i].radius * std::sin(angle);
    rings.emplace_back();
    for (int j = 0; j < around; ++j) {
      const double u = 2 * kPi * j / around;
      rings.back().push_back(center + path[i].radius * std::cos(angle) * (side * std::cos(u) + up * std::sin(u)));
    }
  };
  for (int c = 1; c < cap; ++c) add_ring(0, -kPi / 2 * (1 - double(c) / cap));
  for (int i = 0; i < n; ++i) add_ring(i, 0);
  for (int c = 1; c < cap; ++c) add_ring(n - 1, kPi / 2 * c / cap);
  return rings_to_mesh(rings, path[0].center - along(0) * path[0].radius,
                       path[n - 1].center + along(n - 1) * path[n - 1].radius);
}

Mesh lathe(const std::vector<Eigen::Vector2d>& profile, int around) {
  std::vector<std::vector<Vec3>> rings;
  for (std::size_t i = 1; i + 1 < profile.size(); ++i) {
    rings.emplace_back();
    for (int j = 0; j < around; ++j) {
      const double u = 2 * kPi * j / around;
      rings.back().emplace_back(profile[i].x() * std::cos(u), profile[i].x() * std::sin(u), profile[i].y());
    }
  }
  return rings_to_mesh(rings, {0, 0, profile.front().y()}, {0, 0, profile.back().y()});
}

Mesh moved(Mesh mesh, const Eigen::Affine3d& by) {
  for (Vec3& p : mesh.vertices) p = by * p;
  const Eigen::Matrix3d normals = by.linear().inverse().transpose();
  for (Eigen::Vector3f& n : mesh.vertex_normal) n = (normals * n.cast<double>()).normalized().cast<float>();
  if (by.linear().determinant() >= 0) return mesh;
  for (Triangle& f : mesh.faces) std::swap(f[1], f[2]);
  for (Wedges& w : mesh.wedges) std::swap(w.uv[1], w.uv[2]);
  return mesh;
}

namespace {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from, std::size_t before, std::size_t added) {
  if (to.size() == before && from.size() == added)
    to.insert(to.end(), from.begin(), from.end());
  else
    to.clear();
}

}  // namespace

Mesh together(const std::vector<Mesh>& meshes) {
  Mesh all;
  for (const Mesh& m : meshes) {
    const std::size_t v = all.vertices.size(), f = all.faces.size(), dv = m.vertices.size(), df = m.faces.size();
    append(all.vertex_normal, m.vertex_normal, v, dv);
    append(all.vertex_color, m.vertex_color, v, dv);
    append(all.vertex_quality, m.vertex_quality, v, dv);
    append(all.face_color, m.face_color, f, df);
    append(all.face_quality, m.face_quality, f, df);
    all.vertices.insert(all.vertices.end(), m.vertices.begin(), m.vertices.end());
    for (Triangle t : m.faces) {
      for (int& corner : t) corner += int(v);
      all.faces.push_back(t);
    }
  }
  return all;
}

std::vector<char> faces_where(const Mesh& mesh, const std::function<bool(const Vec3&)>& pass) {
  std::vector<char> flags(mesh.faces.size());
  for (int f = 0; f < mesh.face_count(); ++f)
    flags[f] = pass((mesh.corner(f, 0) + mesh.corner(f, 1) + mesh.corner(f, 2)) / 3);
  return flags;
}

Vec3 Random::direction() {
  const double z = uniform(-1, 1), u = uniform(0, 2 * kPi), r = std::sqrt(1 - z * z);
  return {r * std::cos(u), r * std::sin(u), z};
}

Eigen::Matrix3d Random::rotation() { return Eigen::AngleAxisd(uniform(0, 2 * kPi), direction()).toRotationMatrix(); }

namespace {

Mesh random_shape(Random& random) {
  switch (random.below(6)) {
    case 0:
      return sphere(Vec3::Zero(), 1, 3);
    case 1:
      return torus(Vec3::Zero(), 0.8, random.uniform(0.2, 0.4), 40, 20);
    case 2:
      return box(Vec3(-0.8, -0.6, -0.7), Vec3(0.8, 0.6, 0.7), 8);
    case 3:
      return noisy_sphere(Vec3::Zero(), 1, 3, random.uniform(0.1, 0.6), unsigned(random.below(1000)));
    case 4:
      return bush(unsigned(random.below(1000)), 24);
    default: {
      std::vector<Ball> path;
      for (int i = 0; i <= 16; ++i)
        path.push_back({{0.5 * std::sin(i * 0.35), 0, i / 8. - 1}, 0.35 + 0.1 * std::sin(i * 0.9)});
      return tube(path, 20);
    }
  }
}

}  // namespace

Scene random_scene(unsigned seed) {
  Random random(seed);
  Scene scene;
  scene.a = moved(random_shape(random), Eigen::Affine3d(random.rotation()));
  const Vec3 direction = random.direction(), shift = direction * random.uniform(0.5, 1.1);
  Eigen::Affine3d place = Eigen::Affine3d::Identity();
  place.linear() = random.rotation() * random.uniform(0.7, 1.2);
  place.translation() = shift;
  scene.b = moved(random_shape(random), place);
  // The tenth of the faces farthest from the other model.
  const auto far_side = [](const Mesh& mesh, const Vec3& towards) {
    std::vector<double> reach;
    for (int f = 0; f < mesh.face_count(); ++f) reach.push_back(mesh.face_box(f).center().dot(towards));
    std::vector<double> sorted = reach;
    std::nth_element(sorted.begin(), sorted.end() - sorted.size() / 10 - 1, sorted.end());
    const double limit = sorted[sorted.size() - sorted.size() / 10 - 1];
    std::vector<char> flags;
    for (double r : reach) flags.push_back(r >= limit);
    return flags;
  };
  scene.keep_a = far_side(scene.a, -direction);
  scene.keep_b = far_side(scene.b, direction);
  return scene;
}

std::vector<char> share_along(const Mesh& mesh, const Vec3& direction, double share) {
  std::vector<std::pair<double, double>> faces;  // height, area
  double area = 0;
  const auto height = [&](int f) { return direction.dot(mesh.corner(f, 0) + mesh.corner(f, 1) + mesh.corner(f, 2)); };
  for (int f = 0; f < mesh.face_count(); ++f) {
    const double a = (mesh.corner(f, 1) - mesh.corner(f, 0)).cross(mesh.corner(f, 2) - mesh.corner(f, 0)).norm();
    faces.emplace_back(height(f), a);
    area += a;
  }
  std::sort(faces.rbegin(), faces.rend());
  double above = 0, limit = 0;
  for (const auto& [h, a] : faces) {
    limit = h;
    if ((above += a) >= share * area) break;
  }
  std::vector<char> flags;
  for (int f = 0; f < mesh.face_count(); ++f) flags.push_back(height(f) >= limit);
  return flags;
}

}  // namespace parts::test
