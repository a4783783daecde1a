// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/class_preset.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace parts::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kDeepest = 16;                 // a preset has three levels
constexpr std::uint64_t kLongest = 1 << 20;  // bytes
constexpr const char* kNamed = "The class preset";

/// @return nothing if it is not a JSON object
std::optional<Json> object_of(const std::string& text) {
  bool too_deep = false;
  const Json::parser_callback_t watch = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > kDeepest) too_deep = true;
    return !too_deep;
  };
  try {
    Json json = Json::parse(text, watch, true, true);
    if (too_deep || !json.is_object()) return {};
    return json;
  } catch (const Json::exception&) {
    return {};
  }
}

/// The object in the preset's file; an empty one where there is none.
Json read_object(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return Json::object();
  const std::optional<Json> object = object_of(InputFile(path, kNamed).read_all(kLongest));
  if (!object)
    throw UserError(std::string(kNamed) + " \"" + path + "\" cannot be read; make it valid JSON, or take it away.");
  return *object;
}

std::optional<std::string> as_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  if (value.is_number_integer()) return value.dump();
  if (!value.is_number()) return {};
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value.get<double>());
  return text;
}

std::optional<double> as_number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

std::optional<Vec3> as_direction(const Json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_array() || found->size() != 3) return {};
  Vec3 v;
  for (std::size_t i = 0; i < 3; ++i) v[Eigen::Index(i)] = (*found)[i].is_number() ? (*found)[i].get<double>() : 0;
  if (!v.allFinite() || !(v.norm() > 0) || !std::isfinite(v.norm())) return {};
  return v;
}

ClassPreset preset_of(const Json& object) {
  ClassPreset preset;
  preset.up = as_direction(object, "Up");
  preset.front = as_direction(object, "Front");
  for (const auto& [filter, values] : object.items()) {
    if (!values.is_object()) continue;
    for (const auto& [name, value] : values.items())
      if (const auto text = as_text(value)) preset.values[filter][name] = *text;
  }
  return preset;
}

Json as_value(const std::string& text) {
  const std::optional<double> number = as_number(text);
  if (!number) return text;
  const bool whole = *number == std::floor(*number) && std::abs(*number) < 1e15;
  return whole ? Json(std::int64_t(*number)) : Json(*number);
}

Json as_list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

std::optional<std::string> ClassPreset::text(const std::string& filter, const std::string& parameter) const {
  const auto of_filter = values.find(filter);
  if (of_filter == values.end()) return {};
  const auto value = of_filter->second.find(parameter);
  if (value == of_filter->second.end()) return {};
  return value->second;
}

std::optional<double> ClassPreset::number(const std::string& filter, const std::string& parameter) const {
  const std::optional<std::string> value = text(filter, parameter);
  return value ? as_number(*value) : std::nullopt;
}

std::string class_preset_path(const std::string& database) {
  std::error_code error;
  if (fs::is_directory(database, error)) return (fs::path(database) / "class.json").string();
  return fs::path(database).replace_extension(".class.json").string();
}

std::optional<ClassPreset> parse_class_preset(const std::string& text) {
  const std::optional<Json> object = object_of(text);
  if (!object) return {};
  return preset_of(*object);
}

ClassPreset read_class_preset(const std::string& database) {
  return preset_of(read_object(class_preset_path(database)));
}

void add_class_preset(OutputFiles& files, const ClassPreset& preset, const std::string& database) {
  const std::string path = class_preset_path(database);
  Json object = read_object(path);
  if (preset.up) object["Up"] = as_list(*preset.up);
  if (preset.front) object["Front"] = as_list(*preset.front);
  for (const auto& [filter, values] : preset.values) {
    Json& of_filter = object[filter];
    if (!of_filter.is_object()) of_filter = Json::object();
    for (const auto& [name, value] : values) of_filter[name] = as_value(value);
  }
  files.add(path, object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", kNamed);
}

void write_class_preset(const ClassPreset& preset, const std::string& database) {
  OutputFiles files;
  add_class_preset(files, preset, database);
  files.commit();
}

}  // namespace parts::io
