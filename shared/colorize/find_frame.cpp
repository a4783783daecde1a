// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/colorize/find_frame.h"

#include <algorithm>
#include <cmath>

#include "parts/colorize/color_examples.h"
#include "parts/colorize/posed_mesh.h"

namespace parts::colorize {
namespace {

constexpr int kModels = 8;        // that are compared with
constexpr int kPixels = 48;       // of views
constexpr double kClearly = 0.6;  // of the present misfit

using Reliefs = std::vector<synthesis::PatchImage>;  ///< a view each

/// The reliefs' mean squared differences as shares of the model's own, of all views.
double misfit(const Reliefs& query, const Reliefs& model) {
  double sum = 0;
  for (std::size_t v = 0; v < model.size(); ++v) {
    const double spread = relief_spread(model[v]);
    sum += relief_difference(model[v], query[v], true) / std::max(spread * spread, 1e-9);
  }
  return sum / double(model.size());
}

/// The least of a few models, but one.
double misfit(const Reliefs& query, const std::vector<Reliefs>& models, int without = -1) {
  double least = 1e9;
  for (int m = 0; m < int(models.size()); ++m)
    if (m != without) least = std::min(least, misfit(query, models[m]));
  return least;
}

/// Small pictures from the front and the side, in which a mesh fits however it stands.
class Viewer {
 public:
  Viewer(const Mesh& posed, examples::ClassModels& models, const ColorizeMeshOptions& options)
      : rendering_(options.rendering) {
    rendering_.width = rendering_.height = kPixels;
    double reach = 0;
    for (const Triangle& f : posed.faces)
      for (int v : f) reach = std::max(reach, posed.vertices[v].cwiseAbs().maxCoeff());
    const double shrink = double(kPixels) / std::min(options.rendering.width, options.rendering.height);
    frame_ = std::min(models.frame() * shrink, 0.48 * kPixels / std::max(reach, 1e-9));
  }
  Reliefs look(const examples::ClassModel& model) const {
    return planes_of(see(model, frame_, {{0, 0}, {90, 0}}, rendering_));
  }

 private:
  examples::ExampleOptions rendering_;
  double frame_;
};

/// +x, -x, +y, -y, +z, -z.
Vec3 axis(int i) {
  Vec3 a = Vec3::Zero();
  a[i / 2] = i % 2 ? -1 : 1;
  return a;
}

/// How a mesh is turned that stands so, to stand like the models.
Eigen::Matrix3d turn(const Standing& from, const Standing& to) {
  return render::view_rotation({}, to.up, to.front).transpose() * render::view_rotation({}, from.up, from.front);
}

}  // namespace

std::optional<Standing> find_frame(const Mesh& posed, examples::ClassModels& models,
                                   const ColorizeMeshOptions& options) {
  if (models.size() < 1) return {};
  const Viewer viewer(posed, models, options);
  const Standing of_models{options.rendering.up, options.rendering.front}, given{options.up, options.front};
  std::vector<Reliefs> members;
  for (int i = 0, n = std::min(kModels, models.size()); i < n; ++i)
    members.push_back(viewer.look(models.get(i * models.size() / n)));
  double oddest = 0;
  for (int m = 0; m < int(members.size()) && members.size() > 1; ++m)
    oddest = std::max(oddest, misfit(members[m], members, m));

  examples::ClassModel turned;
  turned.mesh.faces = posed.faces;
  const auto misfit_of = [&](const Eigen::Matrix3d& by) {
    turned.mesh.vertices.clear();
    for (const Vec3& v : posed.vertices) turned.mesh.vertices.push_back(by * v);
    return misfit(viewer.look(turned), members);
  };
  const double present = misfit_of(Eigen::Matrix3d::Identity());
  if (present <= oddest) return {};
  double least = kClearly * present;
  std::optional<Standing> best;
  const Eigen::Matrix3d back = turn(given, of_models).transpose();  // to the mesh as it is
  for (int up = 0; up < 6; ++up)
    for (int front = 0; front < 6; ++front) {
      if (up / 2 == front / 2) continue;
      const Standing s{axis(up), axis(front)};
      if (const double m = misfit_of(turn(s, of_models) * back); m < least) least = m, best = s;
    }
  return best;
}

}  // namespace parts::colorize
