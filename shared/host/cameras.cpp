// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/host/cameras.h"

#include <QFileInfo>

#include "parts/base/error.h"
#include "parts/render/mlp_camera.h"

namespace parts::host {

using Scalar = Shotm::ScalarType;

Shotm to_shot(const render::Camera& camera, double distance) {
  const io::MlpCamera c = render::to_mlp(camera, distance);
  Shotm shot;
  shot.Extrinsics.SetTra(vcg::Point3<Scalar>(-c.translation.x(), -c.translation.y(), -c.translation.z()));
  vcg::Matrix44<Scalar> rotation;
  rotation.SetIdentity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rotation.ElementAt(i, j) = Scalar(c.rotation(i, j));
  shot.Extrinsics.SetRot(rotation);
  shot.Intrinsics.cameraType = decltype(shot.Intrinsics.cameraType)(c.type);  // an int, later an enum
  shot.Intrinsics.FocalMm = Scalar(c.focal_mm);
  shot.Intrinsics.ViewportPx = vcg::Point2i(c.viewport_px.x(), c.viewport_px.y());
  shot.Intrinsics.PixelSizeMm = vcg::Point2<Scalar>(Scalar(c.pixel_mm.x()), Scalar(c.pixel_mm.y()));
  shot.Intrinsics.CenterPx = vcg::Point2<Scalar>(Scalar(c.center_px.x()), Scalar(c.center_px.y()));
  shot.Intrinsics.DistorCenterPx = shot.Intrinsics.CenterPx;
  return shot;
}

std::optional<render::Camera> to_camera(const Shotm& shot) {
  io::MlpCamera c;
  c.given = true;
  const vcg::Point3<Scalar> eye = shot.Extrinsics.Tra();
  c.translation = -Vec3(eye.X(), eye.Y(), eye.Z());
  const vcg::Matrix44<Scalar> rotation = shot.Extrinsics.Rot();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) c.rotation(i, j) = rotation.ElementAt(i, j);
  c.type = shot.Intrinsics.cameraType;
  c.focal_mm = shot.Intrinsics.FocalMm;
  c.viewport_px = {shot.Intrinsics.ViewportPx.X(), shot.Intrinsics.ViewportPx.Y()};
  c.pixel_mm = {shot.Intrinsics.PixelSizeMm.X(), shot.Intrinsics.PixelSizeMm.Y()};
  c.center_px = {shot.Intrinsics.CenterPx.X(), shot.Intrinsics.CenterPx.Y()};
  try {
    return render::from_mlp(c, "");
  } catch (const UserError&) {
    return {};
  }
}

void set_camera(const render::Camera& camera, MeshModel& layer) {
  layer.updateDataMask(MeshModel::MM_CAMERA);
  const vcg::Point3<Scalar> middle = layer.cm.bbox.Center();
  layer.cm.shot = to_shot(camera, camera.project(Vec3(middle.X(), middle.Y(), middle.Z())).z());
}

void write_raster(const Outcome::NewRaster& raster, RasterModel& layer) {
  layer.setLabel(QString::fromStdString(raster.name));
  layer.shot = to_shot(raster.camera, raster.distance);
  api::add_plane(QFileInfo(QString::fromStdString(raster.file)).absoluteFilePath(), layer);
}

}  // namespace parts::host
