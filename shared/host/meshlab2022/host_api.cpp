// SPDX-License-Identifier: GPL-3.0-or-later
#include "host_api.h"

#include <common/utilities/load_save.h>

#include <QDir>
#include <QTemporaryDir>
#include <map>
#include <memory>

#include "parts/base/error.h"

namespace parts::host::api {

namespace {

/// Textures as files for the length of a run, each image once.
class TextureFiles {
 public:
  /// @param read_from  where the image may have come from
  QString file_of(const QImage& image, const QString& name, const QString& read_from) {
    for (const auto& [file, known] : known_)
      if (known.image.cacheKey() == image.cacheKey()) return file;
    if (QFileInfo::exists(read_from) && QImage(read_from) == image) {
      known_[read_from] = {image, name};
      return read_from;
    }
    const QString folder = folder_.filePath(QString::number(known_.size()));
    const QString file = QDir(folder).filePath(QFileInfo(name).completeBaseName() + ".png");
    if (!QDir().mkpath(folder) || !image.save(file, "PNG", 80))  // little effort: it is read once
      throw UserError("A texture cannot be written to " + QDir::tempPath().toStdString() + "; free some space there.");
    known_[file] = {image, name};
    return file;
  }

  /// The image of a file, and the name that it has in a mesh.
  struct Texture {
    QImage image;
    QString name;
  };
  Texture of(const QString& file) const {
    const auto known = known_.find(file);
    return known == known_.end() ? Texture{QImage(file), file} : known->second;
  }

 private:
  QTemporaryDir folder_;
  std::map<QString, Texture> known_;
};

/// Those of the current run; the host runs one filter at a time.
std::unique_ptr<TextureFiles>& texture_files() {
  static std::unique_ptr<TextureFiles> files;
  if (!files) files = std::make_unique<TextureFiles>();
  return files;
}

/// A plain name that the layer has not: textures of two folders may have the same.
std::string free_name(const QFileInfo& file, const MeshModel& layer) {
  QString name = file.fileName();
  for (int i = 2; layer.getTextures().count(name.toStdString()); ++i)
    name = file.completeBaseName() + "_" + QString::number(i) + "." + file.suffix();
  return name.toStdString();
}

}  // namespace

std::vector<MeshModel*> layers_of(const MeshDocument& document) {
  std::vector<MeshModel*> layers;
  for (const MeshModel& layer : document.meshIterator()) layers.push_back(const_cast<MeshModel*>(&layer));
  return layers;
}

const RasterModel* raster_of(const MeshDocument& document) { return document.rm(); }
void remove(MeshModel& layer, MeshDocument& document) { document.delMesh(layer.id()); }
void remove(RasterModel& raster, MeshDocument& document) { document.delRaster(raster.id()); }
void update_box_and_normals(MeshModel& layer) { layer.updateBoxAndNormals(); }
void add_plane(const QString& file, RasterModel& raster) { raster.addPlane(new RasterPlane(file, RasterPlane::RGBA)); }

std::string texture_file(const MeshModel& layer, const std::string& name) {
  const QImage image = layer.getTexture(name);
  const QString texture = QString::fromStdString(name);
  const QString folder = layer.fullName().isEmpty() ? QDir::currentPath() : layer.pathName();
  const QString beside = QDir::cleanPath(QDir(folder).absoluteFilePath(texture));
  return (image.isNull() ? beside : texture_files()->file_of(image, texture, beside)).toStdString();
}

void set_textures(const std::vector<std::string>& files, MeshModel& layer) {
  for (const std::string& file : files) {
    const TextureFiles::Texture texture = texture_files()->of(QString::fromStdString(file));
    layer.addTexture(free_name(QFileInfo(texture.name), layer),
                     texture.image.isNull() ? meshlab::getDummyTexture() : texture.image);
  }
}

void forget_texture_files() { texture_files().reset(); }

void add_layer(RichParameterList& list, bool advanced, const QString& name, MeshModel* layer,
               const MeshDocument& document, const QString& label, const QString& help) {
  list.addParam(RichMesh(name, layer ? unsigned(layer->id()) : 0u, &document, label, help, advanced));
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

// Lengths, choices, files and layers are plain numbers and texts since 2022.
std::optional<double> as_length(const Value& value) { return as_number(value); }
std::optional<int> as_choice(const Value& value) { return as_integer(value); }

std::optional<Point3m> as_point(const Value& value) {
#ifdef PARTS_HOST_RENAMED_PARAMETERS
  if (!value.isPoint3()) return {};
  return value.getPoint3();
#else
  if (!value.isPoint3f()) return {};
  return value.getPoint3f();
#endif
}

std::optional<QString> as_text(const Value& value) {
  if (!value.isString()) return {};
  return value.getString();
}

std::optional<QString> as_file(const Value& value) { return as_text(value); }

std::optional<MeshModel*> as_layer(const Value& value, const MeshDocument& document) {
  if (!value.isInt()) return {};
  return const_cast<MeshModel*>(document.getMesh(unsigned(value.getInt())));
}

}  // namespace parts::host::api
