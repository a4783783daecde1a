// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The API of MeshLab 2022.02 to 2025.07 and of PyMeshLab, in single or double
// precision, in the names that the rest of the layer uses. The folder of
// another generation of hosts has a header of the same name with the same
// functions.
#include <common/ml_document/mesh_document.h>
#include <common/plugins/interfaces/filter_plugin.h>

#if __has_include(<common/parameters/rich_parameters.h>)  // since 2023.12
#include <common/parameters/rich_parameters.h>
#define PARTS_HOST_RENAMED_PARAMETERS
#endif

#include <optional>
#include <string>
#include <vector>

namespace parts::host::api {

using FilterPlugin = ::FilterPlugin;

/// All layers, in the document's order.
std::vector<MeshModel*> layers_of(const MeshDocument& document);
/// The current raster layer; null where there is none.
const RasterModel* raster_of(const MeshDocument& document);
void remove(MeshModel& layer, MeshDocument& document);
void remove(RasterModel& raster, MeshDocument& document);
void update_box_and_normals(MeshModel& layer);
/// Adds an image file as the first plane of a raster layer.
void add_plane(const QString& file, RasterModel& raster);

/// A file with the image of one of a layer's textures, absolute: that beside the
/// mesh where it is still the same, or one made from the image that the host has.
std::string texture_file(const MeshModel& layer, const std::string& name);
/// Gives a new layer the textures of these files, absolute, under names that are
/// plain and unique: the host saves each beside the mesh under its name. What
/// cannot be read gets the image that the host shows in its place.
void set_textures(const std::vector<std::string>& files, MeshModel& layer);
/// Where texture_file() made files: they go. Called at the end of each run.
void forget_texture_files();

#ifdef PARTS_HOST_RENAMED_PARAMETERS
using RichLength = RichPercentage;
using RichReadFile = RichFileOpen;
using RichWriteFile = RichFileSave;
#else
using RichLength = RichAbsPerc;
using RichReadFile = RichOpenFile;
using RichWriteFile = RichSaveFile;
#endif
using RichPoint = RichPosition;
/// Adds a parameter. @param advanced  shown on demand, by hosts that can
template <class Rich, class... Arguments>
void add(RichParameterList& list, bool advanced, const Arguments&... arguments) {
  list.addParam(Rich(arguments..., advanced));
}
/// @param layer  the default; may be null
void add_layer(RichParameterList& list, bool advanced, const QString& name, MeshModel* layer,
               const MeshDocument& document, const QString& label, const QString& help);

/// What a value holds; nothing where it is of another type.
std::optional<bool> as_flag(const Value& value);
std::optional<int> as_integer(const Value& value);
std::optional<double> as_number(const Value& value);
std::optional<double> as_length(const Value& value);
std::optional<int> as_choice(const Value& value);
std::optional<Point3m> as_point(const Value& value);
std::optional<QString> as_text(const Value& value);
std::optional<QString> as_file(const Value& value);
/// Null where there is no such layer.
std::optional<MeshModel*> as_layer(const Value& value, const MeshDocument& document);

}  // namespace parts::host::api
