// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/mlp_project.h"

#include <expat.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>

#include "parts/base/error.h"
#include "parts/io/mesh_formats.h"

namespace parts::io {
namespace {

namespace fs = std::filesystem;
using formats::Malformed;

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

/// Builds the project from expat's calls. Exceptions must not cross expat (a C
/// library): the first is kept, and the parser stopped.
class Reader {
 public:
  Reader(fs::path folder, XML_Parser parser) : folder_(std::move(folder)), parser_(parser) {
    XML_SetUserData(parser, this);
    XML_SetElementHandler(parser, start, end);
    XML_SetCharacterDataHandler(parser, text);
  }

  MlpProject project;
  bool is_project = false;
  std::exception_ptr error;

 private:
  using Attributes = const XML_Char**;

  template <class Call>
  void guarded(const Call& call) {
    try {
      if (!error) call();
    } catch (...) {
      error = std::current_exception();
      XML_StopParser(parser_, XML_FALSE);
    }
  }
  static void start(void* self, const XML_Char* name, Attributes attributes) {
    Reader& r = *static_cast<Reader*>(self);
    r.guarded([&] { r.open(name, attributes); });
  }
  static void end(void* self, const XML_Char* name) {
    Reader& r = *static_cast<Reader*>(self);
    r.guarded([&] { r.close(name); });
  }
  static void text(void* self, const XML_Char* bytes, int n) {
    Reader& r = *static_cast<Reader*>(self);
    r.guarded([&] {
      if (r.in_matrix_) r.matrix_.append(bytes, std::size_t(n));
    });
  }

  static const char* attribute(Attributes attributes, std::string_view name) {
    for (; *attributes; attributes += 2)
      if (attributes[0] == name) return attributes[1];
    return "";
  }
  std::string file(std::string name) const {
    if (name.empty()) return name;
    std::error_code e;
    if (!fs::exists(folder_ / name, e)) {  // written on another system
      std::string slashed = name;
      std::replace(slashed.begin(), slashed.end(), '\\', '/');
      if (fs::exists(folder_ / slashed, e)) name = slashed;
    }
    return (folder_ / name).lexically_normal().string();
  }

  void open(const std::string& name, Attributes attributes) {
    if (name == "MeshLabProject") {
      is_project = true;
    } else if (name == "MLMesh") {
      MlpMesh mesh;
      mesh.label = attribute(attributes, "label");
      mesh.file = file(attribute(attributes, "filename"));
      project.meshes.push_back(mesh);
      in_mesh_ = true;
    } else if (name == "MLMatrix44" && in_mesh_) {
      in_matrix_ = true;
      matrix_.clear();
    } else if (name == "MLRaster") {
      project.rasters.emplace_back();
      project.rasters.back().label = attribute(attributes, "label");
      in_raster_ = true;
    } else if (name == "VCGCamera" && in_raster_) {
      project.rasters.back().camera = camera(attributes);
    } else if (name == "Plane" && in_raster_) {
      MlpPlane plane;
      plane.file = file(attribute(attributes, "fileName"));
      const std::string_view semantic = attribute(attributes, "semantic");
      if (!semantic.empty()) plane.semantic = int(numbers("a plane's semantic", semantic, 1, false)[0]);
      project.rasters.back().planes.push_back(plane);
    }
  }

  void close(const std::string& name) {
    if (name == "MLMatrix44" && in_matrix_) {
      in_matrix_ = false;
      if (matrix_.find_first_not_of(" \t\r\n") == std::string::npos) return;
      const std::vector<double> m = numbers("a matrix", matrix_, 16, false);
      project.meshes.back().matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
    } else if (name == "MLMesh") {
      in_mesh_ = false;
    } else if (name == "MLRaster") {
      in_raster_ = false;
    }
  }

  static MlpCamera camera(Attributes attributes) {
    MlpCamera c;
    c.given = true;
    const auto read = [&](const char* name, std::size_t n, const auto& use) {
      const std::string_view value = attribute(attributes, name);
      if (!value.empty()) use(numbers("the camera's " + std::string(name), value, n, true));
    };
    using Values = std::vector<double>;
    const auto whole = [](double v) { return int(std::clamp(v, 0.0, double(INT_MAX))); };
    read("TranslationVector", 3, [&](const Values& v) { c.translation = Eigen::Vector3d(v[0], v[1], v[2]); });
    read("RotationMatrix", 11, [&](const Values& v) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) c.rotation(i, j) = v[4 * i + j];
    });
    read("FocalMm", 1, [&](const Values& v) { c.focal_mm = v[0]; });
    read("ViewportPx", 2, [&](const Values& v) { c.viewport_px = Eigen::Vector2i(whole(v[0]), whole(v[1])); });
    read("PixelSizeMm", 2, [&](const Values& v) { c.pixel_mm = Eigen::Vector2d(v[0], v[1]); });
    read("CenterPx", 2, [&](const Values& v) { c.center_px = Eigen::Vector2d(v[0], v[1]); });
    read("LensDistortion", 2, [&](const Values& v) { c.distortion = Eigen::Vector2d(v[0], v[1]); });
    read("CameraType", 1, [&](const Values& v) { c.type = whole(v[0]); });
    return c;
  }

  fs::path folder_;
  XML_Parser parser_;
  bool in_mesh_ = false, in_raster_ = false, in_matrix_ = false;
  std::string matrix_;
};

void append_escaped(std::string& out, std::string_view text) {
  for (char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
}

void append_attribute(std::string& out, const char* name, std::string_view value) {
  out.append(" ").append(name).append("=\"");
  append_escaped(out, value);
  out += '"';
}

void append_attribute(std::string& out, const char* name, std::initializer_list<double> values) {
  std::string text;
  for (double v : values) {
    if (!text.empty()) text += ' ';
    formats::append(text, v);
  }
  append_attribute(out, name, text);
}

std::string camera_element(const MlpCamera& c) {
  std::string out = "   <VCGCamera";
  const Eigen::Matrix3d& r = c.rotation;
  append_attribute(out, "TranslationVector", {c.translation[0], c.translation[1], c.translation[2], 1});
  append_attribute(out, "RotationMatrix",
                   {r(0, 0), r(0, 1), r(0, 2), 0, r(1, 0), r(1, 1), r(1, 2), 0,  //
                    r(2, 0), r(2, 1), r(2, 2), 0, 0, 0, 0, 1});
  append_attribute(out, "CameraType", {double(c.type)});
  append_attribute(out, "BinaryData", "0");
  append_attribute(out, "FocalMm", {c.focal_mm});
  append_attribute(out, "LensDistortion", {c.distortion[0], c.distortion[1]});
  append_attribute(out, "PixelSizeMm", {c.pixel_mm[0], c.pixel_mm[1]});
  append_attribute(out, "ViewportPx", {double(c.viewport_px[0]), double(c.viewport_px[1])});
  append_attribute(out, "CenterPx", {c.center_px[0], c.center_px[1]});
  return out + "/>\n";
}

std::string named_from(const fs::path& folder, const std::string& file) {
  if (file.empty()) return file;
  std::error_code error;
  const fs::path relative = fs::relative(file, folder, error);
  return error || relative.empty() ? file : relative.generic_string();
}

std::string project_text(const MlpProject& project, const fs::path& folder) {
  std::string out = "<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n <MeshGroup>\n";
  for (const MlpMesh& m : project.meshes) {
    out += "  <MLMesh";
    append_attribute(out, "label", m.label);
    append_attribute(out, "filename", named_from(folder, m.file));
    append_attribute(out, "visible", "1");
    out += ">\n   <MLMatrix44>\n";
    for (int i = 0; i < 4; ++i, out += '\n')
      for (int j = 0; j < 4; ++j, out += ' ') formats::append(out, m.matrix(i, j));
    out += "</MLMatrix44>\n  </MLMesh>\n";
  }
  out += " </MeshGroup>\n <RasterGroup>\n";
  for (const MlpRaster& r : project.rasters) {
    out += "  <MLRaster";
    append_attribute(out, "label", r.label);
    out += ">\n" + camera_element(r.camera);
    for (const MlpPlane& p : r.planes) {
      out += "   <Plane";
      append_attribute(out, "fileName", named_from(folder, p.file));
      append_attribute(out, "semantic", {double(p.semantic)});
      out += "/>\n";
    }
    out += "  </MLRaster>\n";
  }
  return out + " </RasterGroup>\n</MeshLabProject>\n";
}

}  // namespace

MlpProject read_mlp(const std::string& path) {
  const std::string file = "The project \"" + path + "\" ";
  std::error_code error;
  if (!fs::exists(path, error)) throw UserError(file + "does not exist; check its name and folder.");
  std::ifstream stream(path, std::ios::binary);
  if (!fs::is_regular_file(path, error) || !stream)
    throw UserError(file + "cannot be read; check that it is a file and may be opened.");
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (bytes.size() > std::size_t(INT_MAX)) throw UserError(file + "is too large for a MeshLab project; save it again.");
  const std::string remedy = "; save it again with MeshLab.";

  const std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser(XML_ParserCreate(nullptr), XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  Reader reader(fs::path(path).parent_path(), parser.get());
  const XML_Status status = XML_Parse(parser.get(), bytes.data(), int(bytes.size()), XML_TRUE);
  if (reader.error) try {
      std::rethrow_exception(reader.error);
    } catch (const Malformed& e) {
      throw UserError(file + e.what() + remedy);
    }
  if (status != XML_STATUS_OK)
    throw UserError(file + "is damaged in line " + std::to_string(XML_GetCurrentLineNumber(parser.get())) + " (" +
                    XML_ErrorString(XML_GetErrorCode(parser.get())) + ")" + remedy);
  if (!reader.is_project) throw UserError(file + "is not a MeshLab project" + remedy);
  return std::move(reader.project);
}

void write_mlp(const MlpProject& project, const std::string& path) {
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  const std::string text = project_text(project, folder);
  const std::string draft = path + ".part";
  std::ofstream file(draft, std::ios::binary);
  file.write(text.data(), std::streamsize(text.size()));
  file.close();
  std::error_code error;
  if (file) fs::rename(draft, path, error);
  if (!file || error) {
    fs::remove(draft, error);
    throw UserError("The project \"" + path + "\" cannot be written; check its folder and the space left.");
  }
}

}  // namespace parts::io
