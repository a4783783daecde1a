// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/search/model_raster.h"

#include <algorithm>
#include <cmath>

namespace parts::search {
namespace {

constexpr int kMargin = 4;  // voxels around the model's box

/// Fills the voxels with their nearest samples: from those that hold one, in two
/// sweeps over the grid, each voxel handing on what it knows.
class Filler {
 public:
  Filler(RasterLevel& level, const std::vector<RasterPoint>& samples, double reach)
      : level_(level), samples_(samples), most_(float(reach * reach) * level.cell * level.cell) {
    level.nearest.assign(std::size_t(level.dims[0]) * level.dims[1] * level.dims[2], RasterLevel::kFar);
    best_.assign(level.nearest.size(), most_);
  }

  void fill() {
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      std::array<int, 3> c;
      for (int d = 0; d < 3; ++d)
        c[d] = std::clamp(int((samples_[s].at[d] - level_.low[d]) / level_.cell), 0, level_.dims[d] - 1);
      offer(index(c[0], c[1], c[2]), center(c[0], c[1], c[2]), std::uint16_t(s));
    }
    sweep(1);
    sweep(-1);
  }

 private:
  int index(int x, int y, int z) const { return x + level_.dims[0] * (y + level_.dims[1] * z); }
  Eigen::Vector3f center(int x, int y, int z) const {
    return level_.low + level_.cell * Eigen::Vector3f(float(x) + 0.5f, float(y) + 0.5f, float(z) + 0.5f);
  }
  void offer(int voxel, const Eigen::Vector3f& at, std::uint16_t sample) {
    const float d = (samples_[sample].at - at).squaredNorm();
    if (d < best_[voxel]) best_[voxel] = d, level_.nearest[voxel] = sample;
  }
  void sweep(int way) {
    const auto& n = level_.dims;
    const auto from = [&](int d) { return way > 0 ? 0 : n[d] - 1; };
    for (int z = from(2); z >= 0 && z < n[2]; z += way)
      for (int y = from(1); y >= 0 && y < n[1]; y += way)
        for (int x = from(0); x >= 0 && x < n[0]; x += way) hand_on(x, y, z, way);
  }
  /// To the 13 neighbours that the sweep has yet to pass.
  void hand_on(int x, int y, int z, int way) {
    const std::uint16_t sample = level_.nearest[index(x, y, z)];
    if (sample == RasterLevel::kFar) return;
    for (int k = 0; k < 13; ++k) {
      const int a = x - way * (k % 3 - 1), b = y - way * (k / 3 % 3 - 1), c = z - way * (k / 9 - 1);
      if (a < 0 || b < 0 || c < 0 || a >= level_.dims[0] || b >= level_.dims[1] || c >= level_.dims[2]) continue;
      const int there = index(a, b, c);
      if (level_.nearest[there] != sample) offer(there, center(a, b, c), sample);
    }
  }

  RasterLevel& level_;
  const std::vector<RasterPoint>& samples_;
  float most_;
  std::vector<float> best_;
};

}  // namespace

RasterLevel nearest_samples(const std::vector<RasterPoint>& samples, const Eigen::AlignedBox3f& box, int resolution,
                            double reach) {
  RasterLevel level;
  level.cell = box.sizes().maxCoeff() / float(resolution);
  for (int d = 0; d < 3; ++d) {
    level.dims[d] = int(std::ceil(box.sizes()[d] / level.cell)) + 2 * kMargin;
    level.low[d] = box.center()[d] - 0.5f * level.cell * float(level.dims[d]);
  }
  Filler(level, samples, reach).fill();
  return level;
}

ModelRaster rasterize_model(const Mesh& model, int levels) {
  const spatial::Surface surface = spatial::make_surface(model, {}, "database");
  ModelRaster raster;
  raster.origin = surface.origin;
  raster.size = surface.size;
  raster.area = surface.area();
  for (const spatial::Sample& s : spatial::sample_surface(surface, ModelRaster::kSamples))
    raster.samples.push_back({s.point.cast<float>(), s.normal.cast<float>()});
  for (int l = 0; l < levels; ++l) add_level(raster);
  return raster;
}

void add_level(ModelRaster& raster) {
  const int l = int(raster.levels.size());
  // The coarsest level knows the way from everywhere.
  raster.levels.push_back(
      nearest_samples(raster.samples, raster.box(), ModelRaster::kCoarsest << l, l == 0 ? 1e4 : RasterLevel::kReach));
}

spatial::Closest RasterTarget::closest(const Vec3& p, int&) const {
  std::uint16_t sample = RasterLevel::kFar;
  for (int l = level_; sample == RasterLevel::kFar; --l) {
    sample = raster_.levels[l].at(p);
    if (l == 0) break;
  }
  const RasterPoint& s = raster_.samples[sample];
  return {s.at.cast<double>(), s.normal.cast<double>()};
}

}  // namespace parts::search
