// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mend/patch_color.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "parts/render/rasterize.h"
#include "parts/render/surface_color.h"
#include "parts/spatial/closest_face.h"

namespace parts::mend {
namespace {

constexpr double kFinest = 1e6;  // pixels: a texture's own resolution
constexpr Color kWhite{255, 255, 255, 255};

bool has_texture(const Mesh& m) {
  return !m.textures.empty() &&
         std::any_of(m.wedges.begin(), m.wedges.end(), [](const Wedges& w) { return w.texture >= 0; });
}

Color color_at(const Mesh& mesh, const render::Textures& textures, int face, const Eigen::Vector3f& barycentric) {
  const Eigen::Vector3f bgr = render::surface_color(mesh, textures, face, barycentric, kFinest, kWhite);
  Color c = kWhite;
  for (int k = 0; k < 3; ++k) c[k] = std::uint8_t(std::clamp(bgr[2 - k] + 0.5f, 0.f, 255.f));
  return c;
}

void drop_texture(Mesh& mesh) { mesh.wedges.clear(), mesh.textures.clear(); }

double to_linear(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }
double to_srgb(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055; }

Vec3 light_of(const Color& c) { return {to_linear(c[0] / 255.0), to_linear(c[1] / 255.0), to_linear(c[2] / 255.0)}; }

/// Which vertices are the patch's own, and which it shares with the scan.
enum Place : char { kScan, kRim, kPatch };
std::vector<char> places(const Mesh& mesh, const std::vector<int>& source) {
  std::vector<char> scan(mesh.vertices.size(), 0), patch = scan, place(mesh.vertices.size(), kScan);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f]) (source[f] < 0 ? patch : scan)[v] = 1;
  for (std::size_t v = 0; v < place.size(); ++v)
    if (patch[v]) place[v] = scan[v] ? kRim : kPatch;
  return place;
}

/// The harmonic field over the patch with the values given at its rim.
/// @param value  in: at the rim; out: everywhere on the patch
void spread(const Mesh& mesh, const std::vector<int>& source, const std::vector<char>& place,
            std::vector<Vec3>& value) {
  std::vector<int> row(mesh.vertices.size(), -1);
  int n = 0;
  for (std::size_t v = 0; v < row.size(); ++v)
    if (place[v] == kPatch) row[v] = n++;
  if (n == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 3);
  constexpr double kHold = 1e-9;  // where no rim is reached: no change
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, kHold);
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (source[f] >= 0) continue;
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.faces[f][k], b = mesh.faces[f][(k + 1) % 3];
      const double length = (mesh.vertices[a] - mesh.vertices[b]).norm(), weight = length > 0 ? 1 / length : 1;
      for (const auto& [u, v] : {std::array<int, 2>{a, b}, std::array<int, 2>{b, a}}) {
        if (row[u] < 0) continue;
        entries.emplace_back(row[u], row[u], weight);
        if (row[v] >= 0)
          entries.emplace_back(row[u], row[v], -weight);
        else
          right.row(row[u]) += weight * value[v].transpose();
      }
    }
  }
  Eigen::SparseMatrix<double> laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(laplacian);
  const Eigen::MatrixXd field = solver.solve(right);
  if (solver.info() != Eigen::Success || !field.allFinite()) return;
  for (std::size_t v = 0; v < row.size(); ++v)
    if (row[v] >= 0) value[v] = field.row(row[v]).transpose();
}

}  // namespace

std::vector<Color> sampled_vertex_colors(const Mesh& mesh) {
  const render::Textures textures = render::load_textures(mesh);
  std::vector<Color> color;
  if (!render::has_colors(mesh, textures)) return color;
  color.assign(mesh.vertices.size(), kWhite);
  std::vector<char> done(mesh.vertices.size(), 0);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k)
      if (const int v = mesh.faces[f][k]; !done[v])
        color[v] = color_at(mesh, textures, f, Eigen::Vector3f::Unit(k)), done[v] = 1;
  return color;
}

void take_kind_of_colors(const Mesh& scan, Mesh& model) {
  if (has_texture(scan)) {
    if (!has_texture(model) && model.vertex_color.empty() && !model.face_color.empty())
      model.vertex_color = sampled_vertex_colors(model);
    return;
  }
  if (!scan.vertex_color.empty()) {
    if (has_texture(model) || model.vertex_color.empty())
      if (std::vector<Color> color = sampled_vertex_colors(model); !color.empty())
        model.vertex_color = std::move(color);
    drop_texture(model);
  } else if (!scan.face_color.empty()) {
    const render::Textures textures = render::load_textures(model);
    if (render::has_colors(model, textures)) {
      std::vector<Color> color;
      for (int f = 0; f < model.face_count(); ++f)
        color.push_back(color_at(model, textures, f, Eigen::Vector3f::Constant(1.f / 3)));
      model.face_color = std::move(color);
    }
    model.vertex_color.clear();
    drop_texture(model);
  } else {
    model.vertex_color.clear(), model.face_color.clear();
    drop_texture(model);
  }
}

void color_vertices_of_scan(const Mesh& scan, const std::vector<int>& source, Mesh& mesh) {
  if (!has_texture(scan) || !scan.vertex_color.empty() || mesh.vertex_color.empty()) return;
  const std::vector<Color> color = sampled_vertex_colors(scan);
  if (color.empty()) return;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; source[f] >= 0 && k < 3; ++k)
      mesh.vertex_color[mesh.faces[f][k]] = Color(color[scan.faces[source[f]][k]]);
}

void match_colors(const Mesh& scan, const Mesh& model, const std::vector<int>& source, Mesh& mesh) {
  if (scan.vertex_color.empty() && !has_texture(scan)) return;
  if (mesh.vertex_color.empty() || model.vertex_color.empty()) return;
  const std::vector<char> place = places(mesh, source);
  const spatial::ClosestFace on_model(model);
  if (on_model.empty()) return;
  std::vector<Vec3> change(mesh.vertices.size(), Vec3::Zero());
  int hint = 0;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (place[v] != kRim) continue;
    const spatial::FaceHit hit = on_model(mesh.vertices[v], hint);
    Vec3 there = Vec3::Zero();
    for (int k = 0; k < 3; ++k) there += hit.barycentric[k] * light_of(model.vertex_color[model.faces[hit.face][k]]);
    change[v] = light_of(mesh.vertex_color[v]) - there;
  }
  spread(mesh, source, place, change);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (place[v] != kPatch) continue;
    const Vec3 light = light_of(mesh.vertex_color[v]) + change[v];
    for (int k = 0; k < 3; ++k)
      mesh.vertex_color[v][k] = std::uint8_t(255 * std::clamp(to_srgb(std::max(light[k], 0.0)), 0.0, 1.0) + 0.5);
  }
}

}  // namespace parts::mend
