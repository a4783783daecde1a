// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/mlp_camera.h"

#include <Eigen/LU>
#include <cmath>

#include "parts/base/error.h"

namespace parts::render {
namespace {

constexpr double kFilmMm = 36;  // width of the film that focal lengths in mm refer to
constexpr int kOrthographic = 1;

}  // namespace

// MeshLab's rows run upwards from the bottom of the image.
io::MlpCamera to_mlp(const Camera& camera, double distance) {
  io::MlpCamera out;
  out.given = true;
  out.translation = -camera.eye;
  out.rotation = camera.rotation;
  out.viewport_px = {camera.width, camera.height};
  out.center_px = {camera.center.x(), camera.height - camera.center.y()};
  if (camera.focal > 0) {
    out.pixel_mm.setConstant(kFilmMm / camera.width);
    out.focal_mm = camera.focal * kFilmMm / camera.width;
  } else {
    out.type = kOrthographic;
    out.pixel_mm.setConstant(1 / camera.scale);
    out.focal_mm = distance;
  }
  return out;
}

Camera from_mlp(const io::MlpCamera& camera, const std::string& label) {
  const std::string raster = "The raster \"" + label + "\" has ";
  const std::string remedy = "; build the database again, or align the raster in MeshLab.";
  if (!camera.given) throw UserError(raster + "no camera" + remedy);
  if (camera.viewport_px.minCoeff() <= 0) throw UserError(raster + "a camera without a viewport" + remedy);
  if (!(camera.pixel_mm.minCoeff() > 0) ||
      std::abs(camera.pixel_mm.x() - camera.pixel_mm.y()) > 1e-3 * camera.pixel_mm.x())
    throw UserError(raster + "a camera whose pixels are not squares" + remedy);
  const bool orthographic = camera.type == kOrthographic;
  if (!orthographic && !(camera.focal_mm > 0)) throw UserError(raster + "a camera without a focal length" + remedy);
  if (!(std::abs(camera.rotation.determinant() - 1) < 0.01))
    throw UserError(raster + "a camera whose matrix is no rotation" + remedy);
  Camera out;
  out.rotation = camera.rotation;
  out.eye = -camera.translation;
  out.width = camera.viewport_px.x();
  out.height = camera.viewport_px.y();
  out.center = {camera.center_px.x(), out.height - camera.center_px.y()};
  if (orthographic)
    out.scale = 1 / camera.pixel_mm.x();
  else
    out.focal = camera.focal_mm / camera.pixel_mm.x();
  return out;
}

}  // namespace parts::render
