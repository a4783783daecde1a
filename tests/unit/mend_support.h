// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Busts with holes and scars, and what the tests of mending ask of the results.

#include <unistd.h>

#include <filesystem>
#include <memory>

#include "compose_support.h"
#include "parts/io/mesh_io.h"
#include "parts/mend/mend.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/prepare.h"
#include "parts/spatial/closest_face.h"
#include "support/busts.h"

namespace parts::test {

constexpr int kCells = 36;

inline std::vector<mend::PlacedModel> other_busts(int count) {
  static std::vector<mend::PlacedModel> models;  // made once
  for (int i = int(models.size()); i < count; ++i)
    models.push_back({bust_mesh(random_bust(unsigned(20 + i)), "other.png", kCells), "bust " + std::to_string(i)});
  return {models.begin(), models.begin() + count};
}

inline const Mesh& own_bust() {
  static const Mesh bust = bust_mesh(random_bust(3), "own.png", kCells);  // made once
  return bust;
}

/// A bust much like own_bust().
inline const std::vector<mend::PlacedModel>& similar_bust() {
  static std::vector<mend::PlacedModel> models;
  if (models.empty()) {
    BustShape shape = random_bust(3);
    shape.nose_width *= 1.1, shape.nose_forward *= 0.92, shape.head_width *= 1.04, shape.jaw_width *= 1.05;
    shape.cheek *= 0.8, shape.brow *= 1.2;
    models.push_back({bust_mesh(shape, "other.png", kCells), "similar"});
  }
  return models;
}

inline double rms(const std::vector<Vec3>& points, const Mesh& surface) {
  const spatial::ClosestFace closest(surface);
  double sum = 0;
  for (const Vec3& p : points) sum += std::pow(closest(p).distance, 2);
  return std::sqrt(sum / double(points.size()));
}

inline std::vector<Vec3> within(const Mesh& mesh, const Vec3& center, double radius) {
  std::vector<Vec3> points;
  for (const Vec3& v : mesh.vertices)
    if ((v - center).norm() < radius) points.push_back(v);
  return points;
}

/// Faces of a mesh that the result does not have, bit for bit.
inline int missing(const Mesh& mesh, const Mesh& result, const std::function<bool(int)>& counts) {
  const std::set<FaceKey> keys = face_keys(result);
  int n = 0;
  for (int f = 0; f < mesh.face_count(); ++f) n += counts(f) && !keys.count(face_key(mesh, f));
  return n;
}

inline mend::RegionOptions around_holes() {
  mend::RegionOptions o;
  o.by = mend::RegionBy::Holes;
  return o;
}

inline mend::Restored fill_quietly(const Mesh& scan, const std::vector<mend::PlacedModel>& models,
                                   const mend::RestoreOptions& options = {},
                                   const mend::RegionOptions& where = around_holes()) {
  Progress silent;
  const mend::Scan ready(scan);
  return mend::mend_region(ready, mend::hole_regions(ready, where).at(0), models, options, silent);
}

/// 0 the scan's, 1 the model's, 2 made by the stitch.
inline int maker(int source) { return source >= 0 ? 0 : source == mend::kFromModel ? 1 : 2; }

inline mend::Restored restore_quietly(const Mesh& scan, const mend::RegionOptions& where,
                                      const std::vector<mend::PlacedModel>& models,
                                      const mend::RestoreOptions& options = {}) {
  Progress silent;
  const mend::Scan ready(scan);
  return mend::mend_region(ready, mend::flaw_regions(ready, where, silent).at(0), models, options, silent);
}

/// A folder with models, opened as a database; it goes with this.
class Database {
 public:
  explicit Database(const std::vector<Mesh>& models) {
    std::filesystem::create_directories(folder_);
    for (std::size_t i = 0; i < models.size(); ++i)
      io::write_mesh(models[i], (folder_ / ("model_" + std::to_string(i) + ".ply")).string());
    Progress silent;
    opened_ = std::make_unique<io::ModelDatabase>(folder_.string(), silent);
  }
  ~Database() { std::filesystem::remove_all(folder_); }
  const io::ModelDatabase& operator*() const { return *opened_; }

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("mend_" + std::to_string(::getpid()) + "_" + std::to_string(++made_));
  std::unique_ptr<io::ModelDatabase> opened_;
  static inline int made_ = 0;
};

inline mend::Mended fill_all(const Mesh& scan, const std::vector<Mesh>& models,
                             const mend::RegionOptions& where = around_holes(), Progress progress = {}) {
  const Database database(models);
  mend::MendOptions options;
  options.fill = true;
  options.region = where;
  return mend::mend_scan(scan, &*database, options, progress);
}

struct NoseHole {
  BustShape shape = random_bust(3);
  const Mesh& whole = own_bust();
  Vec3 tip = bust_landmarks(shape).nose_tip;
  Mesh scan = mesh::prepare(without_ball(whole, tip, 0.16)).mesh;
};

}  // namespace parts::test
