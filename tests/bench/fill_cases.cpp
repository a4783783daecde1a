// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/fill_cases.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>

#include "parts/base/disjoint_sets.h"
#include "parts/io/mesh_io.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/prepare.h"
#include "parts/render/rasterize.h"
#include "parts/spatial/closest_face.h"
#include "support/busts.h"

namespace parts::bench {
namespace {

namespace fs = std::filesystem;

/// A landmark of the JSON file beside a head.
Vec3 landmark(const fs::path& head, const std::string& name) {
  std::ifstream in(fs::path(head).replace_extension("json"));
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const auto at = text.find('[', text.find('"' + name + '"'));
  Vec3 p = Vec3::Zero();
  if (at != std::string::npos) std::sscanf(text.c_str() + at, "[ %lf, %lf, %lf", &p[0], &p[1], &p[2]);
  return p;
}

/// Per vertex: a face of it shows in one of 26 views.
std::vector<char> seen_from_outside(const Mesh& mesh) {
  std::vector<char> seen(mesh.vertices.size(), 0);
  render::RenderOptions options;
  options.colors = false;
  for (int yaw = 0; yaw < 360; yaw += 45)
    for (int pitch = -45; pitch <= 45; pitch += 45) {
      const Eigen::Matrix3d turn = render::view_rotation({double(yaw), double(pitch)}, Vec3::UnitY(), Vec3::UnitZ());
      const render::Rendering r =
          render::render(mesh, {}, render::orthographic_camera(turn, mesh.bounds(), 300, 300), options);
      for (int y = 0; y < r.face.rows; ++y)
        for (int x = 0; x < r.face.cols; ++x)
          if (const int f = r.face.at<int>(y, x); f >= 0)
            for (int v : mesh.faces[f]) seen[v] = 1;
    }
  return seen;
}

Member read_member(const std::string& file) {
  Member m;
  m.file = file;
  m.mesh = mesh::prepare(io::read_mesh(file)).mesh;
  m.mesh.wedges.clear(), m.mesh.textures.clear();
  return m;
}

Mesh dented(const Mesh& whole, const Vec3& at, const DamageCase& c, double radius, double unit, unsigned seed,
            std::vector<char>& touched) {
  Mesh scan = whole;
  mesh::update_normals(scan);
  std::mt19937 random(seed);
  const auto noise = [&] { return double(random()) / 4294967296.0 - 0.5; };
  const Vec3 along = Vec3(noise(), noise(), noise()).normalized();  // of a gouge: its walls face this way
  for (int v = 0; v < scan.vertex_count(); ++v) {
    const Vec3 d = (whole.vertices[v] - at) / radius;
    if (d.norm() >= 1) continue;
    const double fall = std::pow(1 - d.squaredNorm(), 2), across = d.dot(along) / 0.3;
    double depth = 0, rough = 0;
    if (c.kind == DamageCase::Dent) depth = 0.2 * fall, rough = 0.08 * fall;
    if (c.kind == DamageCase::Gouge) depth = 0.2 * std::exp(-across * across) * (1 - d.norm()), rough = 0.03 * fall;
    if (c.kind == DamageCase::Noise) rough = 0.15 * fall;
    scan.vertices[v] -= unit * depth * scan.vertex_normal[v].cast<double>();
    scan.vertices[v] += unit * rough * Vec3(noise(), noise(), noise());
    touched[v] = 1;
  }
  scan.vertex_normal.clear();
  return scan;
}

/// Of the vertices above a height the one with the largest x: an ear's.
long leftmost(const std::vector<Vec3>& v, double height) {
  const auto key = [&](const Vec3& p) { return p.y() > height ? p.x() : -1e9; };
  return std::max_element(v.begin(), v.end(), [&](auto& a, auto& b) { return key(a) < key(b); }) - v.begin();
}

/// Of the faces within a ball those that hang together with the one nearest its
/// centre: the cheek, and not the inside of the mouth behind it.
std::vector<char> sheet_around(const Mesh& mesh, const Vec3& at, double radius) {
  std::vector<char> inside(mesh.faces.size());
  DisjointSets sets(mesh.vertex_count());
  for (int f = 0; f < mesh.face_count(); ++f) {
    inside[f] = (mesh.center(f) - at).norm() < radius;
    if (inside[f]) sets.unite(mesh.faces[f][0], mesh.faces[f][1]), sets.unite(mesh.faces[f][0], mesh.faces[f][2]);
  }
  const int sheet = sets.find(mesh.faces[spatial::ClosestFace(mesh, inside)(at).face][0]);
  for (int f = 0; f < mesh.face_count(); ++f) inside[f] = inside[f] && sets.find(mesh.faces[f][0]) == sheet;
  return inside;
}

}  // namespace

std::vector<std::string> files_of(const std::string& folder, const std::string& extension) {
  std::vector<std::string> files;
  std::error_code error;
  for (const auto& e : fs::directory_iterator(folder, error))
    if (e.path().extension() == extension) files.push_back(e.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

const std::vector<DamageCase> kDamageCases = {
    {"nose removed", "nose", Vec3(0, 0, 0), 0.45, DamageCase::Hole, true},
    {"crown removed", "crown", Vec3(0, 0, 0), 1.4, DamageCase::Hole, true},
    {"ear removed", "ear", Vec3(0, 0, 0), 0.65, DamageCase::Hole},
    {"cheek removed", "nose", Vec3(0.85, -0.1, -0.7), 0.35, DamageCase::Hole},
    {"eye corner removed", "nose", Vec3(0.75, 0.6, -0.5), 0.3, DamageCase::Hole},
    {"nose broken", "nose", Vec3(0, 0, 0), 0.48, DamageCase::Dent},
    {"nose broken, in a box", "nose", Vec3(0, 0, 0), 0.48, DamageCase::Dent, true},
    {"cheek dented", "nose", Vec3(0.6, -0.2, -0.45), 0.48, DamageCase::Dent},
    {"cheek gouged", "nose", Vec3(-0.6, -0.2, -0.45), 0.48, DamageCase::Gouge},
    {"brow roughened", "nose", Vec3(0, 1.1, 0), 0.48, DamageCase::Noise},
};

MemberClass heads(const std::string& data) {
  MemberClass c{"heads", {}, {}};
  for (const std::string& file : files_of(fs::path(data) / "heads", ".obj")) {
    Member m = read_member(file);
    m.nose_tip = landmark(file, "nose_tip"), m.crown = landmark(file, "crown");
    m.ear = landmark(file, "ear_l");
    m.unit = (landmark(file, "eye_l") - landmark(file, "eye_r")).norm();
    c.members.push_back(std::move(m));
  }
  return c;
}

MemberClass head_shapes(const std::string& data) {
  MemberClass c{"head_shapes", {}, {}};
  long nose = 0, crown = 0, ear = 0;
  for (const std::string& file : files_of(fs::path(data) / "head_shapes", ".ply")) {
    Member m = read_member(file);
    const auto& v = m.mesh.vertices;
    if (c.members.empty()) {
      const auto forward = [](const Vec3& p) { return p.z() - 10 * std::abs(p.x()); };
      nose =
          std::max_element(v.begin(), v.end(), [&](auto& a, auto& b) { return forward(a) < forward(b); }) - v.begin();
      crown = std::max_element(v.begin(), v.end(), [](auto& a, auto& b) { return a.y() < b.y(); }) - v.begin();
      ear = leftmost(v, v[std::size_t(nose)].y());
    }
    m.nose_tip = v.at(std::size_t(nose)), m.crown = v.at(std::size_t(crown)), m.ear = v.at(std::size_t(ear));
    m.unit = 6.3;  // centimetres
    c.members.push_back(std::move(m));
  }
  return c;
}

MemberClass bent(MemberClass c, double amount) {
  c.name += ", bent";
  unsigned seed = 1;
  for (Member& m : c.members) {
    c.models.push_back(m.file);
    std::mt19937 random(seed++);
    const auto number = [&] { return 2 * double(random()) / 4294967296.0 - 1; };
    constexpr int kWaves = 12;
    const double each = amount * m.unit * std::sqrt(6.0 / kWaves);
    std::vector<Vec3> moved = m.mesh.vertices;
    const auto bend = [&](Vec3& p, const Vec3& at, const Vec3& wave, const Vec3& along, double phase) {
      p += each * std::sin(wave.dot(at) + phase) * along;
    };
    for (int w = 0; w < kWaves; ++w) {
      const Vec3 wave = Vec3(number(), number(), number()).normalized() * 2 * M_PI / (m.unit * (2.5 + 1.5 * number()));
      const Vec3 along = Vec3(number(), number(), number()).normalized();
      const double phase = M_PI * number();
      for (std::size_t v = 0; v < moved.size(); ++v) bend(moved[v], m.mesh.vertices[v], wave, along, phase);
      for (Vec3* p : {&m.nose_tip, &m.crown, &m.ear}) bend(*p, *p, wave, along, phase);
    }
    m.mesh.vertices = std::move(moved);
  }
  return c;
}

MemberClass head_scan(const std::string& data) {
  MemberClass c{"head_scan", {}, files_of(fs::path(data) / "heads", ".obj")};
  for (const std::string& file : files_of(fs::path(data) / "head_scan", ".obj")) {
    Member m = read_member(file);
    const auto& v = m.mesh.vertices;
    m.nose_tip = *std::max_element(v.begin(), v.end(), [](auto& a, auto& b) { return a.z() < b.z(); });
    m.crown = *std::max_element(v.begin(), v.end(), [](auto& a, auto& b) { return a.y() < b.y(); });
    m.ear = v[std::size_t(leftmost(v, m.nose_tip.y()))];
    m.unit = 1.5;
    c.members.push_back(std::move(m));
  }
  return c;
}

MemberClass busts(const std::string& folder, int count) {
  MemberClass c{"busts", {}, {}};
  for (int i = 0; i < count; ++i) {
    const test::BustShape shape = test::random_bust(unsigned(100 + i));
    const std::string file = (fs::path(folder) / ("bust_" + std::to_string(i) + ".ply")).string();
    io::write_mesh(test::bust_mesh(shape), file);
    Member m = read_member(file);
    const test::BustLandmarks at = test::bust_landmarks(shape);
    m.nose_tip = at.nose_tip, m.crown = at.crown, m.unit = 2 * shape.eye_distance;
    m.ear = m.mesh.vertices[std::size_t(leftmost(m.mesh.vertices, at.nose_tip.y()))];
    c.members.push_back(std::move(m));
  }
  return c;
}

Damaged damage(const Member& member, const DamageCase& what, unsigned seed) {
  const Mesh& whole = member.mesh;
  const double radius = what.radius * member.unit;
  const std::vector<char> outer = seen_from_outside(whole);
  const std::string near = what.at;
  Vec3 at = (near == "nose" ? member.nose_tip : near == "ear" ? member.ear : member.crown) + member.unit * what.offset;
  if (what.offset != Vec3::Zero()) {
    std::vector<char> outside(whole.faces.size());
    for (int f = 0; f < whole.face_count(); ++f)
      for (int v : whole.faces[f]) outside[f] |= outer[v];
    at = spatial::ClosestFace(whole, outside)(at).point;
  }
  Damaged d;
  std::vector<char> gone(whole.faces.size(), 0), touched(whole.vertices.size(), 0);
  if (what.kind == DamageCase::Hole) {
    gone = sheet_around(whole, at, radius);
    std::vector<char> stays(whole.faces.size());
    for (int f = 0; f < whole.face_count(); ++f) {
      stays[f] = !gone[f];
      if (gone[f])
        for (int v : whole.faces[f]) touched[v] = 1;
    }
    Mesh marked = whole;
    marked.face_selected.assign(whole.faces.size(), 0);
    for (int f = 0; f < whole.face_count(); ++f)
      for (int v : whole.faces[f]) marked.face_selected[f] |= !what.box && touched[v];
    d.scan = mesh::take_faces(marked, stays);
  } else {
    d.scan = dented(whole, at, what, radius, member.unit, seed, touched);
    for (int f = 0; f < whole.face_count(); ++f)
      for (int v : whole.faces[f]) gone[f] |= touched[v];
    if (!what.box) d.scan.face_selected = gone;
  }
  for (int v = 0; v < whole.vertex_count(); ++v)
    if (touched[v]) d.truth.push_back(whole.vertices[v]), d.outer.push_back(outer[v]);
  if (what.kind == DamageCase::Hole || what.box) {
    d.region.by = what.box ? mend::RegionBy::Box : mend::RegionBy::Selection;
    for (const Vec3& p : d.truth) d.region.box.extend(p);
    const double margin = what.kind == DamageCase::Hole ? 0.17 : 0.5 * what.radius;
    d.region.box.min().array() -= margin * member.unit, d.region.box.max().array() += margin * member.unit;
  }
  return d;
}

}  // namespace parts::bench
