// SPDX-License-Identifier: GPL-3.0-or-later
#include "host_api.h"

#include <QDir>

namespace parts::host::api {

std::vector<MeshModel*> layers_of(const MeshDocument& document) {
  return {document.meshList.begin(), document.meshList.end()};
}

const RasterModel* raster_of(const MeshDocument& document) { return const_cast<MeshDocument&>(document).rm(); }
void remove(MeshModel& layer, MeshDocument& document) { document.delMesh(&layer); }
void remove(RasterModel& raster, MeshDocument& document) { document.delRaster(&raster); }
void update_box_and_normals(MeshModel& layer) { layer.UpdateBoxAndNormals(); }
void add_plane(const QString& file, RasterModel& raster) { raster.addPlane(new Plane(file, Plane::RGBA)); }

// Mesh files name textures relative to their own folder, which is not the
// current one when a result is shown or saved.
std::string texture_file(const MeshModel& layer, const std::string& name) {
  const QString texture = QString::fromStdString(name);
  const QFileInfo beside(QFileInfo(layer.fullName()).absoluteDir(), texture);
  return (!layer.fullName().isEmpty() && beside.exists() ? beside : QFileInfo(texture))
      .absoluteFilePath()
      .toStdString();
}

void set_textures(const std::vector<std::string>& files, MeshModel& layer) { layer.cm.textures = files; }
void forget_texture_files() {}

void add_layer(RichParameterList& list, bool /*advanced*/, const QString& name, MeshModel* layer,
               const MeshDocument& document, const QString& label, const QString& help) {
  MeshDocument* shown = const_cast<MeshDocument*>(&document);
  // The constructor asserts that a document's parameter has a layer.
  RichMesh parameter(name, layer, layer ? shown : nullptr, label, help);
  parameter.meshdoc = shown;
  list.addParam(parameter);
}

std::optional<bool> as_flag(const Value& value) {
  if (!value.isBool()) return {};
  return value.getBool();
}

std::optional<int> as_integer(const Value& value) {
  if (!value.isInt()) return {};
  return value.getInt();
}

std::optional<double> as_number(const Value& value) {
  if (!value.isFloat()) return {};
  return value.getFloat();
}

std::optional<double> as_length(const Value& value) {
  if (!value.isAbsPerc()) return {};
  return value.getAbsPerc();
}

std::optional<int> as_choice(const Value& value) {
  if (!value.isEnum()) return {};
  return value.getEnum();
}

std::optional<Point3m> as_point(const Value& value) {
  if (!value.isPoint3f()) return {};
  return value.getPoint3f();
}

std::optional<QString> as_text(const Value& value) {
  if (!value.isString()) return {};
  return value.getString();
}

std::optional<QString> as_file(const Value& value) {
  if (!value.isFileName()) return {};
  return value.getFileName();
}

std::optional<MeshModel*> as_layer(const Value& value, const MeshDocument& document) {
  if (!value.isMesh()) return {};
  MeshModel* layer = value.getMesh();
  return document.meshList.contains(layer) ? layer : nullptr;
}

}  // namespace parts::host::api
