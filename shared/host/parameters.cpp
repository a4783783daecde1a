// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/host/parameters.h"

#include <QFileInfo>
#include <cmath>
#include <sstream>

#include "parts/base/error.h"
#include "parts/host/cameras.h"
#include "parts/host/layers.h"
#include "parts/host/sizes.h"

namespace parts::host {

namespace {

// As many as a dialog shows without scrolling; the rest is shown on demand.
constexpr int kPlainParameters = 8;

MeshModel* current_of(const MeshDocument& document) {
  if (document.mm()) return const_cast<MeshModel*>(document.mm());
  const std::vector<MeshModel*> layers = api::layers_of(document);
  return layers.empty() ? nullptr : layers.front();
}

/// The first visible layer that is not the current one, or else a hidden one,
/// or else the current one.
MeshModel* other_of(const MeshDocument& document) {
  MeshModel* other = current_of(document);
  for (MeshModel* layer : api::layers_of(document)) {
    if (layer == current_of(document)) continue;
    if (layer->isVisible()) return layer;
    if (other == current_of(document)) other = layer;
  }
  return other;
}

/// Diagonal of the visible layers: the 100 % of lengths. The host divides by it.
double diagonal_of(const MeshDocument& document) {
  Box box;
  for (const MeshModel* layer : api::layers_of(document))
    if (layer->isVisible()) box.extend(layer_box(*layer));
  const double diagonal = box.isEmpty() ? 0 : box.diagonal().norm();
  return diagonal > 0 && std::isfinite(float(diagonal)) ? diagonal : 1;
}

QStringList to_list(const std::vector<std::string>& values) {
  QStringList list;
  for (const std::string& value : values) list << QString::fromStdString(value);
  return list;
}

/// As the host's file dialogs want them: it joins them with blanks.
QStringList to_patterns(const std::vector<std::string>& endings) {
  QStringList list;
  for (const std::string& ending : endings) list << "*." + QString::fromStdString(ending);
  for (const QString& pattern : QStringList(list)) list << pattern.toUpper();
  return list;
}

std::string shown(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace

Scene scene_of(const MeshDocument& document) {
  Scene scene;
  MeshModel *current = current_of(document), *other = other_of(document);
  if (current) scene.current = layer_box(*current);
  if (other != current) scene.other = layer_box(*other);
  return scene;
}

std::vector<Parameter> parameters_of(const Filter& filter, const Scene& scene) {
  std::vector<Parameter> list = filter.parameters(scene);
  if (filter.makes_mesh)
    list.push_back(flag("AllowFlaws", true, "Allow flaws",
                        "A result with flaws that its inputs do not have (pieces, open borders, edges of more than two "
                        "faces, crossing faces) is added with a warning. Without it the filter fails and changes "
                        "nothing."));
  return list;
}

void declare(const std::vector<Parameter>& parameters, const MeshDocument& document, RichParameterList& list) {
  using Kind = Parameter::Kind;
  int count = 0;
  for (const Parameter& p : parameters) {
    const QString name = QString::fromStdString(p.name), label = QString::fromStdString(p.label),
                  help = QString::fromStdString(p.help), text = QString::fromStdString(p.text);
    const bool advanced = count++ >= kPlainParameters;
    switch (p.kind) {
      case Kind::Flag:
        api::add<RichBool>(list, advanced, name, p.value != 0, label, help);
        break;
      case Kind::Integer:
        api::add<RichInt>(list, advanced, name, int(p.value), label, help);
        break;
      case Kind::Number:
        api::add<RichFloat>(list, advanced, name, Scalarm(p.value), label, help);
        break;
      case Kind::Length:
        api::add<api::RichLength>(list, advanced, name, Scalarm(p.value), 0, Scalarm(diagonal_of(document)), label,
                                  help);
        break;
      case Kind::Choice:
        api::add<RichEnum>(list, advanced, name, int(p.value), to_list(p.values), label, help);
        break;
      case Kind::Point:
        api::add<api::RichPoint>(list, advanced, name, Point3m(p.point.x(), p.point.y(), p.point.z()), label, help);
        break;
      case Kind::Text:
        api::add<RichString>(list, advanced, name, text, label, help);
        break;
      case Kind::OpenFile:
        api::add<api::RichReadFile>(list, advanced, name, text, to_patterns(p.values), label, help);
        break;
      case Kind::SaveFile:
        api::add<api::RichWriteFile>(list, advanced, name, text, to_patterns(p.values).value(0), label, help);
        break;
      case Kind::CurrentLayer:
        api::add_layer(list, advanced, name, current_of(document), document, label, help);
        break;
      case Kind::OtherLayer:
        api::add_layer(list, advanced, name, other_of(document), document, label, help);
        break;
    }
  }
}

RichInputs::RichInputs(std::vector<Parameter> parameters, const RichParameterList& list, const MeshDocument& document)
    : parameters_(std::move(parameters)), list_(list), document_(document) {
  declare(parameters_, document_, defaults_);
}

const Parameter& RichInputs::declaration(const char* name) const {
  for (const Parameter& p : parameters_)
    if (p.name == name) return p;
  throw std::logic_error(std::string("no parameter is called ") + name);
}

const Value& RichInputs::value(const char* name) const {
  return (list_.hasParameter(name) ? list_ : defaults_).getParameterByName(name).value();
}

template <class Given>
Given RichInputs::of_type(const char* name, std::optional<Given> given) const {
  if (given) return *std::move(given);
  // The host would abort on reading it.
  throw UserError("The script gives " + std::string(name) + " as a Rich" + value(name).typeName().toStdString() +
                  "; take its line from the filter's template in scripts/.");
}

double RichInputs::in_range(const char* name, double value) const {
  const Parameter& p = declaration(name);
  if (!std::isfinite(value)) throw UserError(p.name + " is not a number; give one.");
  if (float(value) >= float(p.min) && float(value) <= float(p.max)) return value;  // the host has no doubles
  if (p.kind == Parameter::Kind::Choice)
    throw UserError(p.name + " has no value " + shown(value) + "; give one from 0 to " + shown(p.max) + ".");
  if (p.max >= std::numeric_limits<float>::max())
    throw UserError(p.name + " is " + shown(value) + "; give a value of at least " + shown(p.min) + ".");
  throw UserError(p.name + " is " + shown(value) + "; give a value from " + shown(p.min) + " to " + shown(p.max) + ".");
}

bool RichInputs::flag(const char* name) const { return of_type(name, api::as_flag(value(name))); }

int RichInputs::integer(const char* name) const {
  return int(in_range(name, of_type(name, api::as_integer(value(name)))));
}

double RichInputs::number(const char* name) const { return in_range(name, of_type(name, api::as_number(value(name)))); }

/// Lengths beyond this reach everything in the layers that the filter is about.
double RichInputs::reach() const {
  double reach = 0;
  for (const Parameter& p : parameters_) {
    if (p.kind != Parameter::Kind::CurrentLayer && p.kind != Parameter::Kind::OtherLayer) continue;
    const Box box = layer_box(*layer(p.name.c_str()).model());
    if (!box.isEmpty()) reach = std::max(reach, 1e6 * box.diagonal().norm());
  }
  return reach > 0 ? reach : kLargestSize;
}

double RichInputs::length(const char* name) const {
  const double length = in_range(name, of_type(name, api::as_length(value(name))));
  check_size(name, length);
  return std::min(length, reach());
}

int RichInputs::choice(const char* name) const {
  return int(in_range(name, of_type(name, api::as_choice(value(name)))));
}

Vec3 RichInputs::point(const char* name) const {
  const Point3m p = of_type(name, api::as_point(value(name)));
  Vec3 point(p.X(), p.Y(), p.Z());
  if (!point.allFinite()) throw UserError(std::string(name) + " is not a point; give three numbers.");
  check_size(name, point.cwiseAbs().maxCoeff());
  return point;
}

std::string RichInputs::text(const char* name) const {
  const bool file = declaration(name).kind != Parameter::Kind::Text;
  return of_type(name, file ? api::as_file(value(name)) : api::as_text(value(name))).toStdString();
}

Layer RichInputs::layer(const char* name) const {
  MeshModel* layer = of_type(name, api::as_layer(value(name), document_));
  if (!layer) throw UserError("There is no layer for " + std::string(name) + "; load a mesh and choose it.");
  return Layer(layer);
}

std::optional<RasterLayer> RichInputs::raster() const {
  const RasterModel* raster = api::raster_of(document_);
  if (!raster || raster->planeList.isEmpty()) return {};
  const QString file = raster->planeList.first()->fullName();
  if (file.isEmpty()) return {};
  return RasterLayer{raster->label().toStdString(), QFileInfo(file).absoluteFilePath().toStdString(),
                     to_camera(raster->shot)};
}

}  // namespace parts::host
