// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// MeshLab 2020.09's API, in the names that the rest of the layer uses. The
// folder of another generation of hosts has a header of the same name with the
// same functions.
#include <common/filter_parameter/rich_parameter_list.h>
#include <common/interfaces.h>
#include <common/meshmodel.h>

#include <optional>
#include <string>
#include <vector>

namespace parts::host::api {

using FilterPlugin = MeshFilterInterface;

/// All layers, in the document's order.
std::vector<MeshModel*> layers_of(const MeshDocument& document);
/// The current raster layer; null where there is none.
const RasterModel* raster_of(const MeshDocument& document);
void remove(MeshModel& layer, MeshDocument& document);
void remove(RasterModel& raster, MeshDocument& document);
void update_box_and_normals(MeshModel& layer);
/// Adds an image file as the first plane of a raster layer.
void add_plane(const QString& file, RasterModel& raster);

/// The file of one of a layer's textures, absolute.
std::string texture_file(const MeshModel& layer, const std::string& name);
/// Gives a new layer the textures of these files, absolute.
void set_textures(const std::vector<std::string>& files, MeshModel& layer);
/// Where texture_file() made files: they go. Called at the end of each run.
void forget_texture_files();

using RichLength = RichAbsPerc;
using RichPoint = RichPoint3f;
using RichReadFile = RichOpenFile;
using RichWriteFile = RichSaveFile;
/// Adds a parameter. @param advanced  shown on demand, by hosts that can
template <class Rich, class... Arguments>
void add(RichParameterList& list, bool /*advanced*/, const Arguments&... arguments) {
  list.addParam(Rich(arguments...));
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
