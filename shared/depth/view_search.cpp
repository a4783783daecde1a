// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/depth/view_search.h"

#include <algorithm>
#include <cmath>

#include "parts/depth/small_level.h"

namespace parts::depth {

namespace {

struct Spacing {
  double yaw, pitch;  ///< degrees
  int yaws, pitches;  ///< views on either side
  int objects;
};
constexpr Spacing rounds[] = {{20, 15, 2, 2, 3}, {10, 10, 1, 1, 6}, {5, 5, 1, 1, 6}};

bool known(const std::vector<render::View>& list, const render::View& v) {
  return std::any_of(list.begin(), list.end(), [&](const render::View& w) { return render::angle_between(v, w) < 1; });
}

// The patches that each view's examples give.
std::vector<double> compete(const synthesis::PatchImage& query, Gallery& gallery,
                            const std::vector<render::View>& views, int objects, const DepthOptions& options) {
  std::vector<synthesis::PatchImage> examples;
  std::vector<int> of;
  objects = std::min(objects, gallery.size());
  for (size_t v = 0; v < views.size(); ++v)
    for (int i = 0; i < objects; ++i) {
      synthesis::PatchImage e = gallery.small(i * gallery.size() / objects, views[v]);
      e.planes.resize(2);
      examples.push_back(std::move(e));
      of.push_back(int(v));
    }
  const synthesis::SynthesisResult r =
      synthesize_small(query, examples, synthesis_options(options), std::min(3, options.max_iterations));
  std::vector<double> used(views.size(), 0);
  for (size_t e = 0; e < examples.size(); ++e) used[of[e]] += double(r.used[e]);
  return used;
}

// The mean of the angles around the most used one, weighted by their patches.
render::View mean_view(const std::vector<render::View>& views, const std::vector<double>& used,
                       const Spacing& spacing) {
  const auto nearness = [&](const render::View& a, const render::View& b) {
    const double yaw = (a.yaw - b.yaw) / spacing.yaw, pitch = (a.pitch - b.pitch) / spacing.pitch;
    return yaw * yaw + pitch * pitch;
  };
  size_t best = 0;
  double most = -1;
  for (size_t v = 0; v < views.size(); ++v) {
    double sum = 0;
    for (size_t w = 0; w < views.size(); ++w) sum += used[w] * std::exp(-nearness(views[v], views[w]));
    if (sum > most) most = sum, best = v;
  }
  double total = 0, yaw = 0, pitch = 0;
  for (size_t v = 0; v < views.size(); ++v) {
    if (nearness(views[v], views[best]) > 2.1) continue;
    const double w = used[v] * used[v];  // squared, or views far off would drag the mean to the middle
    total += w, yaw += w * views[v].yaw, pitch += w * views[v].pitch;
  }
  return total > 0 ? render::View{yaw / total, pitch / total} : views[best];
}

}  // namespace

render::View find_view(const synthesis::PatchImage& query, Gallery& gallery, const DepthOptions& options,
                       Progress& progress) {
  if (!gallery.has_any_view()) {
    const std::vector<render::View>& views = gallery.stored_views();
    if (views.size() == 1) return views.front();
    progress.at(0.3);
    return mean_view(views, compete(query, gallery, views, 6, options), rounds[0]);
  }
  std::vector<render::View> centers = options.views;
  render::View view = centers.front();
  double done = 0;
  for (const Spacing& s : rounds) {
    progress.at(done / std::size(rounds));
    std::vector<render::View> views;
    for (const render::View& c : centers)
      for (int i = -s.yaws; i <= s.yaws; ++i)
        for (int j = -s.pitches; j <= s.pitches; ++j) {
          const render::View v{c.yaw + i * s.yaw, std::clamp(c.pitch + j * s.pitch, -89., 89.)};
          if (!known(views, v)) views.push_back(v);
        }
    view = mean_view(views, compete(query, gallery, views, s.objects, options), s);
    centers = {view};
    ++done;
  }
  return view;
}

}  // namespace parts::depth
