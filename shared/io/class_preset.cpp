// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/class_preset.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>

#include "parts/base/error.h"

namespace parts::io {
namespace {

namespace fs = std::filesystem;

std::string as_text(const cv::FileNode& node) {
  if (node.isString()) return std::string(node);
  if (node.isInt()) return std::to_string(int(node));
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", double(node));
  return text;
}

std::optional<double> as_number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

std::optional<Vec3> as_direction(const cv::FileNode& node) {
  if (!node.isSeq() || node.size() != 3) return {};
  Vec3 v;
  for (int i = 0; i < 3; ++i) v[i] = node[i].isReal() || node[i].isInt() ? double(node[i]) : 0;
  if (!v.allFinite() || !(v.norm() > 0)) return {};
  return v;
}

ClassPreset parsed(const cv::FileStorage& file) {
  ClassPreset preset;
  preset.up = as_direction(file["Up"]);
  preset.front = as_direction(file["Front"]);
  const cv::FileNode root = file.root();
  for (const cv::FileNode& filter : root) {
    if (!filter.isMap()) continue;
    for (const cv::FileNode& value : filter)
      if (value.isString() || value.isInt() || value.isReal())
        preset.values[filter.name()][value.name()] = as_text(value);
  }
  return preset;
}

void write_value(cv::FileStorage& file, const std::string& name, const std::string& value) {
  if (const std::optional<double> number = as_number(value))
    file << name << *number;
  else
    file << name << value;
}

void write_direction(cv::FileStorage& file, const char* name, const Vec3& v) {
  file << name << "[" << v.x() << v.y() << v.z() << "]";
}

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

ClassPreset read_class_preset(const std::string& database) {
  const std::string path = class_preset_path(database);
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  try {
    const cv::FileStorage file(path, cv::FileStorage::READ | cv::FileStorage::FORMAT_JSON);
    if (file.isOpened()) return parsed(file);
  } catch (const cv::Exception&) {
  }
  throw UserError("The class preset \"" + path + "\" cannot be read; make it valid JSON, or take it away.");
}

void write_class_preset(const ClassPreset& preset, const std::string& database) {
  const std::string path = class_preset_path(database), draft = path + ".part";
  std::error_code error;
  bool written = false;
  try {
    cv::FileStorage file(draft, cv::FileStorage::WRITE | cv::FileStorage::FORMAT_JSON);
    written = file.isOpened();
    if (written) {
      if (preset.up) write_direction(file, "Up", *preset.up);
      if (preset.front) write_direction(file, "Front", *preset.front);
      for (const auto& [filter, values] : preset.values) {
        file << filter << "{";
        for (const auto& [name, value] : values) write_value(file, name, value);
        file << "}";
      }
    }
    file.release();
  } catch (const cv::Exception&) {
    written = false;
  }
  if (written) fs::rename(draft, path, error);
  if (!written || error) {
    fs::remove(draft, error);
    throw UserError("The class preset \"" + path + "\" cannot be written; check its folder and the space left.");
  }
}

}  // namespace parts::io
