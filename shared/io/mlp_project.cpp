// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/mlp_project.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <pugixml.hpp>
#include <sstream>
#include <string_view>

#include "parts/io/mesh_formats.h"
#include "parts/io/sibling.h"

namespace parts::io {
namespace {

namespace fs = std::filesystem;
using formats::Malformed;

constexpr const char* kNamed = "The project";

/// Exactly n finite numbers; a camera's vectors may have more, which are dropped.
std::vector<double> numbers(const std::string& what, std::string_view text, std::size_t n, bool more_may_follow) {
  std::vector<double> values;
  formats::Scanner scanner(text);
  for (std::string_view w = scanner.word(); !w.empty(); w = scanner.word()) {
    const double value = formats::Scanner::to_number(w);
    if (!std::isfinite(value)) throw Malformed("has a number in " + what + " that is not finite");
    values.push_back(value);
  }
  if (values.size() < n || (values.size() > n && !more_may_follow))
    throw Malformed("has " + std::to_string(values.size()) + " numbers in " + what + " instead of " +
                    std::to_string(n));
  values.resize(n);
  return values;
}

/// The nearest integer that an int can hold.
int whole(double value) { return int(std::clamp(value, double(INT_MIN), double(INT_MAX))); }

MlpCamera camera_of(const pugi::xml_node& element) {
  MlpCamera c;
  c.given = true;
  const auto read = [&](const char* name, std::size_t n, const auto& use) {
    const std::string_view value = element.attribute(name).value();
    if (!value.empty()) use(numbers("the camera's " + std::string(name), value, n, true));
  };
  using Values = std::vector<double>;
  read("TranslationVector", 3, [&](const Values& v) { c.translation = Eigen::Vector3d(v[0], v[1], v[2]); });
  read("RotationMatrix", 11, [&](const Values& v) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) c.rotation(i, j) = v[std::size_t(4 * i + j)];
  });
  read("FocalMm", 1, [&](const Values& v) { c.focal_mm = v[0]; });
  read("ViewportPx", 2,
       [&](const Values& v) { c.viewport_px = Eigen::Vector2i(std::max(0, whole(v[0])), std::max(0, whole(v[1]))); });
  read("PixelSizeMm", 2, [&](const Values& v) { c.pixel_mm = Eigen::Vector2d(v[0], v[1]); });
  read("CenterPx", 2, [&](const Values& v) { c.center_px = Eigen::Vector2d(v[0], v[1]); });
  read("LensDistortion", 2, [&](const Values& v) { c.distortion = Eigen::Vector2d(v[0], v[1]); });
  read("CameraType", 1, [&](const Values& v) { c.type = std::max(0, whole(v[0])); });
  return c;
}

MlpMesh mesh_of(const pugi::xml_node& element) {
  MlpMesh mesh;
  mesh.label = element.attribute("label").value();
  mesh.file = element.attribute("filename").value();
  const std::string_view text = element.child("MLMatrix44").text().get();
  if (text.find_first_not_of(" \t\r\n") == text.npos) return mesh;
  const std::vector<double> m = numbers("a matrix", text, 16, false);
  mesh.matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
  return mesh;
}

MlpRaster raster_of(const pugi::xml_node& element) {
  MlpRaster raster;
  raster.label = element.attribute("label").value();
  if (const pugi::xml_node camera = element.child("VCGCamera")) raster.camera = camera_of(camera);
  for (const pugi::xml_node& node : element.children("Plane")) {
    MlpPlane plane;
    plane.file = node.attribute("fileName").value();
    const std::string_view semantic = node.attribute("semantic").value();
    if (!semantic.empty()) plane.semantic = whole(numbers("a plane's semantic", semantic, 1, false)[0]);
    raster.planes.push_back(plane);
  }
  return raster;
}

/// A project declares its type; entities of its own, which may unfold without bound, it has no use for.
void refuse_entities(const pugi::xml_document& document) {
  for (const pugi::xml_node& node : document.children())
    if (node.type() == pugi::node_doctype && std::strchr(node.value(), '['))
      throw Malformed("is damaged (it declares entities)");
}

MlpProject parsed(const std::string& bytes) {
  pugi::xml_document document;
  const pugi::xml_parse_result result =
      document.load_buffer(bytes.data(), bytes.size(), pugi::parse_default | pugi::parse_doctype);
  if (result.status == pugi::status_out_of_memory) throw std::bad_alloc();
  if (!result) {
    const auto line =
        1 + std::count(bytes.begin(), bytes.begin() + std::clamp<long>(result.offset, 0, long(bytes.size())), '\n');
    throw Malformed("is damaged in line " + std::to_string(line) + " (" + result.description() + ")");
  }
  refuse_entities(document);
  const pugi::xml_node root = document.child("MeshLabProject");
  if (!root) throw Malformed("is not a MeshLab project");
  MlpProject project;
  for (const pugi::xml_node& group : root.children("MeshGroup"))
    for (const pugi::xml_node& mesh : group.children("MLMesh")) project.meshes.push_back(mesh_of(mesh));
  for (const pugi::xml_node& group : root.children("RasterGroup"))
    for (const pugi::xml_node& raster : group.children("MLRaster")) project.rasters.push_back(raster_of(raster));
  return project;
}

/// Names files such that they open from here.
void place_files(MlpProject& project, const std::string& path) {
  const auto place = [&](std::string& file) {
    if (!file.empty()) file = named_beside(path, file).string();
  };
  for (MlpMesh& mesh : project.meshes) place(mesh.file);
  for (MlpRaster& raster : project.rasters)
    for (MlpPlane& plane : raster.planes) place(plane.file);
}

std::string text_of(std::initializer_list<double> values) {
  std::string text;
  for (double v : values) {
    if (!text.empty()) text += ' ';
    formats::append(text, v);
  }
  return text;
}

void set(pugi::xml_node& element, const char* name, const std::string& value) {
  element.append_attribute(name).set_value(value.c_str());
}

void add_camera(pugi::xml_node& raster, const MlpCamera& c) {
  const Eigen::Matrix3d& r = c.rotation;
  pugi::xml_node camera = raster.append_child("VCGCamera");
  set(camera, "TranslationVector", text_of({c.translation[0], c.translation[1], c.translation[2], 1}));
  set(camera, "RotationMatrix",
      text_of({r(0, 0), r(0, 1), r(0, 2), 0, r(1, 0), r(1, 1), r(1, 2), 0,  //
               r(2, 0), r(2, 1), r(2, 2), 0, 0, 0, 0, 1}));
  set(camera, "CameraType", text_of({double(c.type)}));
  set(camera, "BinaryData", "0");
  set(camera, "FocalMm", text_of({c.focal_mm}));
  set(camera, "LensDistortion", text_of({c.distortion[0], c.distortion[1]}));
  set(camera, "PixelSizeMm", text_of({c.pixel_mm[0], c.pixel_mm[1]}));
  set(camera, "ViewportPx", text_of({double(c.viewport_px[0]), double(c.viewport_px[1])}));
  set(camera, "CenterPx", text_of({c.center_px[0], c.center_px[1]}));
}

std::string named_from(const fs::path& folder, const std::string& file) {
  if (file.empty()) return file;
  std::error_code error;
  const fs::path relative = fs::relative(file, folder, error);
  return error || relative.empty() ? file : relative.generic_string();
}

std::string matrix_text(const Eigen::Matrix4d& matrix) {
  std::string text = "\n";
  for (int i = 0; i < 4; ++i, text += '\n')
    for (int j = 0; j < 4; ++j, text += ' ') formats::append(text, matrix(i, j));
  return text;
}

std::string project_text(const MlpProject& project, const fs::path& folder) {
  pugi::xml_document document;
  document.append_child(pugi::node_doctype).set_value("MeshLabDocument");
  pugi::xml_node root = document.append_child("MeshLabProject");
  pugi::xml_node meshes = root.append_child("MeshGroup"), rasters = root.append_child("RasterGroup");
  for (const MlpMesh& m : project.meshes) {
    pugi::xml_node mesh = meshes.append_child("MLMesh");
    set(mesh, "label", m.label);
    set(mesh, "filename", named_from(folder, m.file));
    set(mesh, "visible", "1");
    mesh.append_child("MLMatrix44").text().set(matrix_text(m.matrix).c_str());
  }
  for (const MlpRaster& r : project.rasters) {
    pugi::xml_node raster = rasters.append_child("MLRaster");
    set(raster, "label", r.label);
    add_camera(raster, r.camera);
    for (const MlpPlane& p : r.planes) {
      pugi::xml_node plane = raster.append_child("Plane");
      set(plane, "fileName", named_from(folder, p.file));
      set(plane, "semantic", text_of({double(p.semantic)}));
    }
  }
  std::ostringstream out;
  document.save(out, " ", pugi::format_indent | pugi::format_no_declaration, pugi::encoding_utf8);
  return out.str();
}

}  // namespace

MlpProject parse_mlp(const std::string& bytes) { return parsed(bytes); }

MlpProject read_mlp(const std::string& path) {
  const InputFile file(path, kNamed);
  try {
    if (file.read(0, 1000).find('<') == std::string::npos) throw Malformed("is damaged (it is not XML)");
    MlpProject project = parsed(file.read_all());
    place_files(project, path);
    return project;
  } catch (const Malformed& e) {
    throw UserError(kNamed + (" \"" + path + "\" ") + e.what() + "; save it again with MeshLab.");
  }
}

void add_mlp(OutputFiles& files, const MlpProject& project, const std::string& path) {
  files.add(path, project_text(project, folder_of(path)), kNamed);
}

void write_mlp(const MlpProject& project, const std::string& path) {
  OutputFiles files;
  add_mlp(files, project, path);
  files.commit();
}

}  // namespace parts::io
