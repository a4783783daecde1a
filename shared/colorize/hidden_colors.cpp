// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/colorize/hidden_colors.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>

#include "parts/base/parallel.h"
#include "parts/mesh/prepare.h"
#include "parts/render/surface_color.h"
#include "parts/spatial/closest_face.h"

namespace parts::colorize {
namespace {

using Vec3f = Eigen::Vector3f;

/// The model's colours where it is closest to the vertices of faces.
std::vector<Vec3f> model_colors(const Mesh& posed, const std::vector<char>& used, const examples::ClassModel& model,
                                int threads) {
  constexpr double kFinest = 1e12;
  const spatial::ClosestFace closest(model.mesh);
  std::vector<Vec3f> color(posed.vertices.size(), Vec3f(0.5f, 128 / 255.f, 128 / 255.f));
  if (closest.empty()) return color;
  parallel_for(posed.vertex_count(), threads, [&](long begin, long end) {
    int hint = 0;
    for (long v = begin; v < end; ++v) {
      if (!used[v] || !posed.vertices[v].allFinite()) continue;
      const spatial::FaceHit hit = closest(posed.vertices[v], hint);
      if (hit.face < 0) continue;
      color[v] = to_ycbcr(render::surface_color(model.mesh, model.textures, hit.face, hit.barycentric.cast<float>(),
                                                kFinest, {200, 200, 200, 255}));
    }
  });
  return color;
}

/// Continues values from the known vertices over the others along edges;
/// vertices that no known one is joined to get a share of 0.
void continue_harmonically(const Mesh& mesh, const std::vector<char>& known, std::vector<Vec3f>& value) {
  constexpr double kPull = 1e-3;                                   // towards 0, so that a solution exists everywhere
  const std::vector<int> place = mesh::first_at_same_place(mesh);  // corners of their own are one place
  std::vector<int> row(mesh.vertices.size(), -1);
  int rows = 0;
  for (const Triangle& f : mesh.faces)
    for (int v : f)
      if (!known[place[v]] && row[place[v]] < 0) row[place[v]] = rows++;
  if (rows == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> degree(std::size_t(rows), kPull);
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(rows, 3);
  for (const Triangle& f : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      const int a = place[f[k]], b = place[f[(k + 1) % 3]];
      for (const auto& [i, j] : {std::pair(a, b), std::pair(b, a)}) {
        if (i == j || row[i] < 0) continue;
        degree[row[i]] += 1;
        if (row[j] >= 0)
          entries.emplace_back(row[i], row[j], -1);
        else
          right.row(row[i]) += value[j].cast<double>();
      }
    }
  for (int i = 0; i < rows; ++i) entries.emplace_back(i, i, degree[i]);
  Eigen::SparseMatrix<double> laplacian(rows, rows);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver;
  solver.setTolerance(1e-4);
  solver.compute(laplacian);
  Eigen::MatrixX3d solution(rows, 3);
  for (int channel = 0; channel < 3; ++channel) {
    solution.col(channel) = solver.solve(right.col(channel));
    // Short of the tolerance a colour is off by less than can be seen; far off
    // the model's own colours are better.
    constexpr double kUsable = 0.01;
    if (solver.info() != Eigen::Success && !(solver.error() < kUsable)) return;
  }
  for (std::size_t v = 0; v < value.size(); ++v)
    if (!known[v] && row[place[v]] >= 0) value[v] = solution.row(row[place[v]]).transpose().cast<float>();
}

}  // namespace

Vec3f to_ycbcr(const Vec3f& bgr) {
  const float y = (0.114f * bgr[0] + 0.587f * bgr[1] + 0.299f * bgr[2]) / 255;
  return {y, (bgr[0] / 255 - y) * 0.564f + 128 / 255.f, (bgr[2] / 255 - y) * 0.713f + 128 / 255.f};
}

void complete_colors(const Mesh& posed, const std::vector<char>& known, const examples::ClassModel& model,
                     std::vector<Eigen::Vector3f>& color, int threads) {
  std::vector<char> used(posed.vertices.size(), 0);  // hidden ones and their neighbours
  for (const Triangle& f : posed.faces)
    if (!known[f[0]] || !known[f[1]] || !known[f[2]])
      for (int v : f) used[v] = 1;
  const std::vector<Vec3f> of_model = model_colors(posed, used, model, threads);
  std::vector<Vec3f> difference(color.size(), Vec3f::Zero());
  for (std::size_t v = 0; v < color.size(); ++v)
    if (known[v] && used[v]) difference[v] = color[v] - of_model[v];
  continue_harmonically(posed, known, difference);
  for (std::size_t v = 0; v < color.size(); ++v)
    if (!known[v]) color[v] = (of_model[v] + difference[v]).cwiseMax(0).cwiseMin(1);
}

}  // namespace parts::colorize
